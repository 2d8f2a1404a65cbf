# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
import copy
import inspect
import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import partpose
from partpose.camera import NoiseOptions, StereoSensorOptions, VirtualDepthCameraOptions
from partpose.dataset import DatasetPreparationConfig
from partpose.descriptor import DescriptorOptions
from partpose.pipeline import (
    CandidateExtras, DatabaseOptions, DebugOptions, Evaluation, GlobalPipelineConfig, Result, VisualizeOptions,
    read_pipeline_config,
)  # fmt: skip
from partpose.preprocess import PreprocessOptions

MODULES = [partpose.camera, partpose.preprocess, partpose.descriptor, partpose.registration, partpose.verification,
           partpose.dataset, partpose.pipeline, partpose.engine, partpose.geometry, partpose.synthesis, partpose.evaluation, partpose.io]  # fmt: skip
DESCRIBED = [c for m in MODULES for c in vars(m).values() if inspect.isclass(c) and "to_dict" in vars(c)]


def instance(cls: type) -> Any:
    try:
        return cls()
    except partpose.Error as error:
        assert "is missing" in str(error) or "must be" in str(error) or "no direction" in str(error), error
        return None


@pytest.mark.parametrize("cls", DESCRIBED, ids=lambda c: c.__name__)
def test_each_field_reads_and_writes_and_survives_copying(cls: type) -> None:
    value = instance(cls)
    if value is None:
        return
    fields = [name for name, member in vars(cls).items() if isinstance(member, property) and member.fset]
    assert fields
    for name in fields:
        before = getattr(value, name)
        setattr(value, name, before)
        assert name in repr(value) and name in (cls.__doc__ or "")
    assert cls(value.to_dict()) == value == copy.deepcopy(value) == copy.copy(value)
    assert pickle.loads(pickle.dumps(value)) == value
    json.dumps(value.to_dict())
    with pytest.raises(partpose.Error, match='unknown key "no_such_key"; did you mean'):
        cls(no_such_key=1)
    assert value != 5 and value != None  # noqa: E711


def test_unknown_keys_name_the_nearest() -> None:
    with pytest.raises(partpose.Error, match='did you mean "min_score"?'):
        partpose.EngineOptions({"min_scor": 0.7})
    assert partpose.RecognizerOptions({"rolls": 6}, min_score=0.8).to_dict()["rolls"] == 6
    with pytest.raises(partpose.Error, match='unknown key "voxel_sise"; did you mean "voxel_size"?'):
        PreprocessOptions(voxel_sise=2)  # type: ignore[call-arg]
    with pytest.raises(partpose.Error, match="preprocessing.voxel_sise"):
        GlobalPipelineConfig({"preprocessing": {"voxel_sise": 2}})
    with pytest.raises(AttributeError):
        PreprocessOptions().voxel_sise  # type: ignore[attr-defined]


@pytest.mark.parametrize("bad", ["big", None, [1], float("nan"), float("inf"), {}, b"x", object(), 1 + 2j, -1])
def test_bad_values_leave_the_field_alone(bad: Any) -> None:
    options = PreprocessOptions(voxel_size=3)
    with pytest.raises(ValueError, match="voxel_size"):
        options.voxel_size = bad
    assert options.voxel_size == 3
    with pytest.raises(ValueError):
        PreprocessOptions(voxel_size=bad)


def test_bad_arguments() -> None:
    with pytest.raises(partpose.Error, match="mapping"):
        PreprocessOptions(5)  # type: ignore[arg-type]
    with pytest.raises(partpose.Error, match="one mapping"):
        PreprocessOptions({}, {})  # type: ignore[call-arg]
    with pytest.raises(partpose.Error, match="keys must be strings"):
        PreprocessOptions({1: 2})  # type: ignore[dict-item]
    with pytest.raises(partpose.Error, match="range"):
        StereoSensorOptions(smoothing_px=2**70)
    with pytest.raises(TypeError):
        PreprocessOptions.voxel_size.fget(GlobalPipelineConfig())  # type: ignore[attr-defined]
    with pytest.raises(TypeError):
        PreprocessOptions.voxel_size.fget(PreprocessOptions.__new__(PreprocessOptions))  # type: ignore[attr-defined]


def test_nested_options_are_live_and_outlive_their_owner() -> None:
    config = GlobalPipelineConfig({"preprocessing": {"voxel_size": 2}}, global_descriptor="esf")
    config.preprocessing.voxel_size = np.float32(4)
    config.vfh = {"k_nn": np.int64(9)}
    assert (config.preprocessing.voxel_size, config.vfh.k_nn, config.global_descriptor) == (4, 9, "esf")
    preprocessing = config.preprocessing
    del config
    assert preprocessing.voxel_size == 4
    noise = NoiseOptions(model="stereo", stereo=StereoSensorOptions(baseline_mm=60))
    assert noise.stereo is not None
    noise.stereo.baseline_mm = 70
    assert noise.stereo is not None and noise.stereo.baseline_mm == 70
    noise.stereo = None
    assert noise.stereo is None
    camera = VirtualDepthCameraOptions(resolution_px=np.array([320, 240]))
    assert camera.resolution_px == (320, 240)
    assert camera.intrinsics().width == 320
    whole = GlobalPipelineConfig()
    assert isinstance(whole.database, DatabaseOptions) and whole.database.noise_levels_mm == (0, 1.5, 3)
    assert isinstance(whole.debug, DebugOptions) and isinstance(whole.debug.visualize, VisualizeOptions)


def test_defaults_are_those_of_the_shipped_files(root: Path) -> None:
    config = read_pipeline_config(root / "configs" / "pipeline_virtual.json")
    assert config.preprocessing == PreprocessOptions()
    assert DescriptorOptions().vfh.k_nn == 6
    assert DatasetPreparationConfig().virtual_views_icosahedron.capture_distance_mm == 650


def test_records_hold_poses() -> None:
    extras = CandidateExtras(T_final=np.eye(4), id=3)
    assert extras.T_final.shape == (4, 4) and extras.T_final.dtype == np.float64
    with pytest.raises(partpose.Error):
        CandidateExtras(T_final=np.zeros((4, 4)))
    for record in (Result, Evaluation):
        with pytest.raises(partpose.Error, match="is missing"):
            record()
