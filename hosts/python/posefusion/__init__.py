"""Dense RGB-D SLAM for rooms in which people move. __init__.pyi says what there is."""
import json as _json

from ._core import Camera, Detector, Error, Frame, PoseFusion, Recording, Segmenter, __version__
from ._core import evaluation_text as _evaluation_text

__all__ = ["Camera", "Detector", "Error", "Frame", "PoseFusion", "Recording", "Segmenter", "evaluate", "__version__"]


def evaluate(groundtruth, estimate, max_stamp_difference=0.02, rpe_delta=1.0):
    """ATE and RPE as the TUM RGB-D benchmark defines them; what `posefusion evaluate --json` prints, as a dict."""
    return _json.loads(_evaluation_text(groundtruth, estimate, max_stamp_difference, rpe_delta))
