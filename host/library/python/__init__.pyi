# SPDX-License-Identifier: MIT
"""Finds a shoe's bite line, and plans a robot's path along it.  Lengths in mm, angles in rad.

Every function may raise Error (the world's fault) and Refused (readable input without a result to trust).
A file is a str or a path.  Arrays that come out are copies, but for those of a Cloud, which are read-only views.
"""
import os
from typing import List, Optional, Sequence, TypedDict, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

File = Union[str, "os.PathLike[str]"]
__version__: str

class Error(Exception):
    next_step: str

class Refused(Error):
    reason_code: str

class Cloud:
    """Points of one scan, z up."""

    def __init__(self, points_mm: ArrayLike) -> None:
        """points_mm: (N, 3), all of them finite."""
    def __len__(self) -> int: ...
    @property
    def points_mm(self) -> NDArray[np.float32]:
        """(N, 3)"""
    @property
    def profile(self) -> NDArray[np.uint32]:
        """(N,) number of each point's profile; (0,) without scan order."""
    @property
    def column(self) -> NDArray[np.uint16]:
        """(N,) picture column of each point; (0,) without scan order."""
    @property
    def sigma_mm(self) -> NDArray[np.float32]:
        """(N,) standard deviation along the camera's ray; (0,) where it is not known."""

def read_cloud(file: File, unit: str = "mm") -> Cloud:
    """unit: mm, cm, m or in, of the file's numbers."""

def write_cloud(file: File, cloud: Cloud) -> None:
    """As binary PLY."""

class Line:
    """Closed: the last point is joined to the first; anticlockwise seen from above."""

    def __init__(self, positions_mm: ArrayLike, normals: ArrayLike, tangents: ArrayLike, confidence: float = 1.0) -> None:
        """Three arrays (N, 3); normals and tangents of unit length."""
    def __len__(self) -> int: ...
    @property
    def length_mm(self) -> float: ...
    @property
    def positions_mm(self) -> NDArray[np.float64]:
        """(N, 3)"""
    @property
    def normals(self) -> NDArray[np.float64]:
        """(N, 3) outward, unit, of the upper beside the line."""
    @property
    def tangents(self) -> NDArray[np.float64]:
        """(N, 3) unit, in the order of the points."""
    @property
    def confidence(self) -> NDArray[np.float64]:
        """(N,) probability that the point is within 0.3 mm of the bite line."""
    @property
    def u95_mm(self) -> NDArray[np.float64]:
        """(N,) radius across the line that holds the true line with 95 %; NaN: not known."""
    @property
    def unsure(self) -> NDArray[np.bool_]:
        """(N,) a person should look."""
    @property
    def source(self) -> List[str]:
        """Of each point: seen, bridged, carried, mended."""

def read_line(file: File) -> Line: ...
def write_line(file: File, line: Line) -> None: ...

class FoundLine:
    line: Line
    confidence: float
    bridged_mm: float
    review: str
    """Why a person must settle the unsure points first; empty: nobody must."""

def find_line(cloud: Cloud) -> FoundLine: ...

class Sample:
    """A scanned shoe with its line; use one for all uppers of its model."""

    def __init__(self, cloud: Cloud, line: Line) -> None: ...

def read_sample(folder: File) -> Sample:
    """A result folder: cloud.ply and line.csv."""

class CarriedLine:
    line: Line
    confidence: float
    bound_mm: float
    shape_rms_mm: float
    bridged_mm: float

def transfer_line(sample: Sample, upper: Cloud, mirror: bool = False, grade: bool = False) -> CarriedLine:
    """mirror: the sample is of the other foot.  grade: it is of another size."""

class Path:
    """A path that passed every check.  This module moves no robot."""

    def __len__(self) -> int: ...
    @property
    def duration_s(self) -> float: ...
    @property
    def T_base_tcp(self) -> NDArray[np.float64]:
        """(N, 4, 4)"""
    @property
    def joints_rad(self) -> NDArray[np.float64]:
        """(N, 6)"""
    @property
    def time_s(self) -> NDArray[np.float64]:
        """(N,)"""
    @property
    def speed_mm_s(self) -> NDArray[np.float64]:
        """(N,) of the tip."""
    @property
    def u95_mm(self) -> NDArray[np.float64]:
        """(N,) of the tip's place across its way; NaN: not known, or beside the line."""
    @property
    def segment(self) -> List[str]:
        """Of each waypoint: approach, line, retreat, travel."""
    def write_csv(self, file: File) -> None: ...

def plan(
    line: Line,
    process_file: File,
    robot: str,
    T_line_base: ArrayLike = ...,
    table_z_mm: float = 0.0,
    cloud: Optional[Cloud] = None,
    from_rad: Optional[Sequence[float]] = None,
) -> Path:
    """T_line_base: (4, 4), the arm's base in the line's frame.  from_rad: six joints where the arm stands before."""

class Head:
    """Camera, laser plane and mounting, as sensor.yaml has them."""

    @property
    def width_px(self) -> int: ...
    @property
    def height_px(self) -> int: ...
    @property
    def T_flange_cam(self) -> NDArray[np.float64]:
        """(4, 4)"""
    @property
    def laser_normal_cam(self) -> NDArray[np.float64]:
        """(3,) unit"""
    @property
    def laser_distance_mm(self) -> float: ...
    def project(self, point_cam_mm: ArrayLike) -> NDArray[np.float64]:
        """(2,) column and row of a picture, pixels."""
    def triangulate(self, columns_px: ArrayLike, rows_px: ArrayLike) -> NDArray[np.float64]:
        """Two arrays (N,) to (N, 3) in the camera's frame, mm."""
    def yaml(self) -> str: ...

def read_head(file: File) -> Head: ...

class Stripe(TypedDict):
    """Each (N,), by column."""

    column_px: NDArray[np.int32]
    row_px: NDArray[np.float32]
    sigma_row_px: NDArray[np.float32]
    amplitude: NDArray[np.float32]
    width_px: NDArray[np.float32]
    sound: NDArray[np.bool_]

def find_stripe(
    picture: ArrayLike, threshold_grey: float = 12.0, width_min_px: float = 1.5, width_max_px: float = 24.0
) -> Stripe:
    """picture: (height, width), grey levels 0 to 255."""

class Calibration:
    head: Head
    good: bool
    reasons: List[str]
    retake: List[str]

def calibrate_head(folder: File) -> Calibration: ...

class Profile:
    """The points of one stripe."""

    sequence: int
    exposure_mid_ns: int
    usable: bool
    @property
    def T_base_cam(self) -> NDArray[np.float64]:
        """(4, 4)"""
    @property
    def points_cam_mm(self) -> NDArray[np.float32]:
        """(N, 3)"""
    @property
    def sigma_mm(self) -> NDArray[np.float32]:
        """(N,)"""
    @property
    def column_px(self) -> NDArray[np.uint16]:
        """(N,)"""

class Recording:
    head: Head
    profiles: List[Profile]
    cloud: Cloud
    lacks: str
    """Why it is not a whole scan; empty: it is whole."""

def read_recording(file: File) -> Recording:
    """scan.btln"""

class SensorClient:
    def __init__(self, endpoint: str, keys: File = ..., name: str = "biteline-python") -> None:
        """endpoint: tcp://HOST:PORT.  keys: folder of this host's keys, compulsory beyond this machine."""
    def scan(self, file: File, timeout_s: float) -> Recording:
        """Asks for a scan, keeps its messages in `file`, which must not exist, and returns at its end."""
