# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""Which CAD part a depth camera sees, and its 6-DoF pose. Lengths are millimetres; camera frame: x right, y down,
z forward; poses are camera_from_model, 4 x 4 float64."""

try:
    from partpose import _partpose as _partpose
except ImportError as error:
    if ".so" in str(error):
        raise ImportError(f"{error}; partpose needs libraries of this system, which its script/setup installs") from error
    raise
from partpose import camera as camera
from partpose import core as core
from partpose import dataset as dataset
from partpose import descriptor as descriptor
from partpose import engine as engine
from partpose import evaluation as evaluation
from partpose import geometry as geometry
from partpose import io as io
from partpose import matching as matching
from partpose import pipeline as pipeline
from partpose import preprocess as preprocess
from partpose import registration as registration
from partpose import report as report
from partpose import sources as sources
from partpose import synthesis as synthesis
from partpose import verification as verification
from partpose._partpose import __version__ as __version__
from partpose.core import DepthImage as DepthImage
from partpose.core import Error as Error
from partpose.core import Intrinsics as Intrinsics
from partpose.core import PointCloud as PointCloud
from partpose.core import TriangleMesh as TriangleMesh
from partpose.engine import Engine as Engine
from partpose.engine import EngineOptions as EngineOptions
from partpose.io import read_scene as read_scene
from partpose.pipeline import Detection as Detection
from partpose.pipeline import Recognition as Recognition
from partpose.pipeline import Recognizer as Recognizer
from partpose.pipeline import RecognizerOptions as RecognizerOptions
from partpose.solution import Solution as Solution
