# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""The reference's facade: every stage takes the JSON files of its appendix C."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from typing import Any

from partpose.core import Error, PointCloud
from partpose.dataset import Dataset, create_dataset, open_dataset, read_dataset_config, read_model_list
from partpose.evaluation import ProtocolFrame, run_protocol
from partpose.io import Scene, read_scene
from partpose.pipeline import GlobalPipeline, Recognition, load_catalogue, read_pipeline_config, write_iteration

_Path = str | os.PathLike[str]
_Progress = Callable[[str, int, int], object] | None

__all__ = ["Solution"]


class Solution:
    """Dataset preparation, offline stage, online stage and accuracy test, each from the JSON files of appendix C."""

    def __init__(self, progress: _Progress = None) -> None:
        self.progress = progress
        self._pipeline: GlobalPipeline | None = None
        self._output: _Path | None = None

    def prepare_dataset(self, dataset_config: _Path, model_list: _Path, output: _Path) -> Dataset:
        """Renders the views of all parts into a dataset folder (C.1): C.1.1 and C.1.2 in, C.1.3 and C.1.4 out."""
        return create_dataset(read_dataset_config(dataset_config), read_model_list(model_list), output, self.progress)

    def offline(self, dataset: _Path, pipeline_config: _Path) -> None:
        """Computes the descriptors of all views and keeps them in the dataset's folder."""
        load_catalogue(open_dataset(dataset), read_pipeline_config(pipeline_config), self.progress)

    def init_online(self, dataset: _Path, pipeline_config: _Path, output: _Path | None = None) -> None:
        """Makes ready to recognize. `output`: where iteration output folders go; None: nowhere."""
        config = read_pipeline_config(pipeline_config)
        catalogue = load_catalogue(open_dataset(dataset), config, self.progress)
        notion = (lambda step: print(step, file=sys.stderr)) if config.debug.step_notion_to_cout else None
        self._pipeline = GlobalPipeline(catalogue, config, notion)
        self._output = output

    def iterate(self, scene: _Path | Scene | PointCloud | Any) -> Recognition:
        """One scene: a file (PCD, PLY, depth PNG), a Scene, a PointCloud or an N x 3 array, in the configuration's
        unit (`preprocessing.scale_flag`)."""
        pipeline = self._ready()
        if isinstance(scene, (str, os.PathLike)):
            scene = read_scene(scene)
        elif isinstance(scene, PointCloud):
            scene = Scene(scene)
        elif not isinstance(scene, Scene):
            scene = Scene(PointCloud(scene))
        recognition = pipeline.recognize(scene)
        config = pipeline.config
        if self._output is not None:
            write_iteration(self._output, recognition, scene, pipeline.catalogue, config)
        if config.debug.result_to_cout:
            print(recognition)
        return recognition

    def test_accuracy(self, test_dataset: _Path) -> list[ProtocolFrame]:
        """Recognizes every view of a dataset and compares with its truth (reference, 6.2.1); with an output folder each
        frame's iteration goes there, with evaluation.json."""
        return run_protocol(self._ready(), open_dataset(test_dataset), self.progress, self._output)

    @property
    def pipeline(self) -> GlobalPipeline:
        """The pipeline that init_online made."""
        return self._ready()

    def _ready(self) -> GlobalPipeline:
        if self._pipeline is None:
            raise Error("Solution: call init_online() first")
        return self._pipeline
