"""Dense RGB-D SLAM for rooms in which people move. __init__.pyi says what there is."""
import json as _json

from ._core import Camera, Detector, Error, Frame, MovingObject, PoseFusion, Recording, Segmenter, __version__
from ._core import evaluation_text as _evaluation_text

__all__ = [
    "Camera",
    "Detector",
    "Error",
    "Frame",
    "MovingObject",
    "PoseFusion",
    "Recording",
    "Segmenter",
    "evaluate",
    "__version__",
]


def evaluate(
    groundtruth,
    estimate,
    max_stamp_difference=0.02,
    rpe_delta=1.0,
    *,
    rpe_delta_unit="s",
    rpe_all_pairs=False,
    align="rigid",
    scale=False,
    match="tum",
    time_offset=0.0
):
    """ATE and RPE as the TUM RGB-D benchmark, or evo, defines them; what `posefusion evaluate --json` prints."""
    offset = None if time_offset == "auto" else time_offset
    return _json.loads(
        _evaluation_text(
            groundtruth,
            estimate,
            max_stamp_difference,
            rpe_delta,
            rpe_delta_unit,
            rpe_all_pairs,
            align,
            scale,
            match,
            offset,
        )
    )
