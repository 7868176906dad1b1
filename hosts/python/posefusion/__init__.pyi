"""Dense RGB-D SLAM for rooms in which people move.

Images are (height, width) arrays; poses are 4 x 4, camera to world (x right, y down, z forward), metres; stamps are
seconds.
    slam = posefusion.PoseFusion(camera)
    slam.process(rgb, depth, stamp)

Options have the keys of the YAML file and of `posefusion run --help`, nested or dotted, in `config` (a dict or the path
of such a file) or as keywords: PoseFusion(camera, {"tracking": {"icp": False}}, scale=0.5). Options about the files of
a run (out, resume, save_map ...) raise Error; in a YAML file, which may be a run's config.yaml, they are passed over.
Computing releases the GIL; threads take turns with one object. At the end of Python, calls that daemon threads
have begun are waited for. A forked child makes objects of its own: those of its parent raise Error there. Values that
make no sense, files and devices that cannot be used raise Error.
"""
from os import PathLike
from typing import Any, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

__version__: str
__all__: list[str]

Config = Mapping[str, Any] | str | PathLike[str] | None

class Error(RuntimeError):
    """One line: what is wrong, where, what to do."""

class Camera:
    """A pinhole camera; the centre of the top left pixel is (0, 0)."""

    def __init__(
        self,
        fx: float,
        fy: float,
        cx: float,
        cy: float,
        width: int,
        height: int,
        depth_scale: float = 5000.0,
        distortion: Sequence[float] = (),
    ) -> None:
        """depth_scale: value of one metre in uint16 depth images; distortion: k1 k2 p1 p2 k3 k4 k5 k6 (OpenCV), any
        number of them."""
    @staticmethod
    def from_file(file: str | PathLike[str]) -> Camera:
        """camera.yaml"""
    @property
    def fx(self) -> float: ...
    @property
    def fy(self) -> float: ...
    @property
    def cx(self) -> float: ...
    @property
    def cy(self) -> float: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def depth_scale(self) -> float: ...
    @property
    def distortion(self) -> list[float]: ...

class Recording:
    """The frames of a recording, as `posefusion run` reads them: for stamp, rgb, depth in Recording(folder): ...
    Such a loop leaves out frames that cannot be used, with a RuntimeWarning each. Ctrl-C ends waiting for a camera or a
    pipe ("raw:-") at once."""

    def __init__(self, source: str | PathLike[str], camera_file: str | PathLike[str] | None = None) -> None:
        """source, and camera_file for --camera, as for `posefusion run`"""
    def __len__(self) -> int:
        """TypeError for a camera, which gives frames without end"""
    def __getitem__(self, index: int) -> tuple[float, NDArray[np.uint8], NDArray[np.float32]]:
        """Stamp, colour and depth in metres, undistorted. Error where the frame cannot be used."""
    def __iter__(self) -> Iterator[tuple[float, NDArray[np.uint8], NDArray[np.float32]]]: ...
    @property
    def camera(self) -> Camera:
        """Of these images."""

class MovingObject:
    """A rigid thing that moves, in a frame in which it was tracked; with objects=True."""

    @property
    def label(self) -> int:
        """In Frame.movers, from 101 on; the same in all frames."""
    @property
    def pose(self) -> NDArray[np.float64]:
        """Object to world, as known in this frame: like Frame.pose without the corrections of later loops."""
    @property
    def pixels(self) -> int:
        """Of Frame.movers, with this label."""

class Frame:
    """What became of a frame."""

    @property
    def pose(self) -> NDArray[np.float64]: ...
    @property
    def covariance(self) -> NDArray[np.float64]:
        """6 x 6, translation (m) and rotation (rad)"""
    @property
    def tracking(self) -> str:
        """'first', 'ok', 'failed' (the pose is held, nothing is fused), 'lost' or 'relocalised'"""
    @property
    def joints(self) -> NDArray[np.float32] | None:
        """(people, 18, 3): u v p in pixels of the images worked on; None: the network did not look"""
    @property
    def labels(self) -> NDArray[np.uint8] | None:
        """0 static, 1..n person, of the images worked on (undistorted, scaled); None: nobody was looked for"""
    @property
    def movers(self) -> NDArray[np.uint8] | None:
        """What else moves: 0 static, 101.. one label per thing; None: nothing. With objects=True a thing has one label
        in all frames, and 255 is what is no object."""
    @property
    def objects(self) -> list[MovingObject]:
        """With objects=True: the rigid things that were tracked, by ascending label."""
    @property
    def people(self) -> int: ...
    @property
    def icp_rmse_m(self) -> float: ...
    @property
    def photometric_rmse(self) -> float: ...
    @property
    def surfels(self) -> int: ...
    @property
    def stable_surfels(self) -> int: ...
    @property
    def loops(self) -> list[dict[str, Any]]:
        """attempts to close a loop in this frame: frame, kind, model_frame, accepted, reason"""

class PoseFusion:
    """The method: people are found and cut out, the rest is tracked and fused."""

    def __init__(self, camera: Camera, config: Config = None, **options: Any) -> None:
        """With load_map=FILE as load_map() does; with localise_only=True as well, that map never changes."""
    def process(
        self,
        rgb: NDArray[np.uint8],
        depth: NDArray[np.uint16] | NDArray[np.floating[Any]],
        stamp: float,
        mask: NDArray[np.uint8] | NDArray[np.bool_] | None = None,
    ) -> Frame:
        """One frame; stamps ascend. rgb: (h, w, 3). depth: uint16 (see Camera.depth_scale) or floats in metres, 0 = no
        measurement, registered to rgb. mask: people, non-zero; None: they are looked for unless no_people=True."""
    def surfels(self, stable_only: bool = True) -> NDArray[np.void]:
        """The map: records with position, normal, color (3 each), radius, confidence and the frame numbers created and
        last_seen."""
    def object_maps(self, stable_only: bool = True) -> dict[int, NDArray[np.void]]:
        """With objects=True: by label the models of all objects so far, each like surfels() but in the frame of its
        object, from which MovingObject.pose leads to the world. created and last_seen count its own frames."""
    def trajectory(self) -> NDArray[np.float64]:
        """(n, 8): stamp tx ty tz qx qy qz qw of all frames, corrected by the loops closed since."""
    def render(self, pose: NDArray[np.floating[Any]]) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Colour and depth of the stable map as seen from a pose."""
    def save_trajectory(self, file: str | PathLike[str]) -> None:
        """As `posefusion run` writes it (TUM format)."""
    def save_surfels(self, file: str | PathLike[str], stable_only: bool = True) -> None:
        """The map as `posefusion run` writes map.ply."""
    def save_map(self, file: str | PathLike[str]) -> None:
        """The complete state of the map as `posefusion run --save-map` writes it, for load_map() and --load-map."""
    def load_map(self, file: str | PathLike[str]) -> None:
        """Goes on in a saved map, instead of the present one. The camera counts as lost, and nothing is fused, until it
        has been found there; frames and stamps begin anew."""
    @property
    def device(self) -> str: ...

class Detector:
    """Joints of people, who are upright in the image or, with rotate="auto" (the default), as those in the
    images before."""

    def __init__(self, config: Config = None, **options: Any) -> None: ...
    def detect(self, rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
        """(people, 18, 3): u v p of the 18 COCO joints, most certain person first; p = 0: not found."""
    @property
    def description(self) -> str: ...

class Segmenter:
    """Cuts people out of depth images. Remembers them from call to call."""

    def __init__(self, camera: Camera, config: Config = None, **options: Any) -> None: ...
    def segment(
        self,
        rgb: NDArray[np.uint8],
        depth: NDArray[np.uint16] | NDArray[np.floating[Any]],
        joints: NDArray[np.floating[Any]] | None = None,
        motion: NDArray[np.floating[Any]] | None = None,
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """Labels (0 static, 1..n person) and the depth without people. joints: as Detector.detect gives them, None: the
        network did not look. motion: of the camera since the previous call, current camera to previous."""

def evaluate(
    groundtruth: NDArray[np.floating[Any]] | str | PathLike[str],
    estimate: NDArray[np.floating[Any]] | str | PathLike[str],
    max_stamp_difference: float = 0.02,
    rpe_delta: float = 1.0,
    *,
    rpe_delta_unit: str = "s",
    rpe_all_pairs: bool = False,
    align: str = "rigid",
    scale: bool = False,
    match: str = "tum",
    time_offset: float | str = 0.0,
) -> dict[str, Any]:
    """ATE and RPE as the TUM RGB-D benchmark defines them, of (n, 8) arrays or files; what `posefusion evaluate --json`
    prints of them. The other arguments are the options of that command: align 'rigid', 'origin' or 'none', match 'tum'
    or 'evo', rpe_delta_unit 's', 'frames', 'm' or 'deg', time_offset seconds or 'auto'."""
