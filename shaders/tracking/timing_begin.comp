#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/se3.glsl"
#include "include/shutter.glsl"
// The previous frame and an earlier one, the reference, as a pair to be compared by track_reduce with TIMING. Now that
// the frame after it is known, so is the previous frame's motion at its stamp.
// in:  record of the newest frame
// out: previous: its motion; pair: pose and gain from the previous camera to the reference's, and the motion of both
layout(local_size_x = 1) in;
readonly buffer Record { TrackingRecord record; };
readonly buffer Reference { TrackingRecord reference; };
buffer Previous { TrackingRecord previous; };
writeonly buffer Pair { TrackingRecord pair; };

void main() {
    Twist motion = scaled(sum(previous.last_motion, record.last_motion), 0.5);
    previous.motion_error = sum(previous.motion_error, sum(motion, scaled(previous.last_motion, -1.0)));
    previous.last_motion = motion;
    pair = previous;
    pair.model_live = compose(inverse_pose(reference.world_live), previous.world_live);
    pair.turn_acceleration = vec4(0.0);
    pair.expected_motion = reference.last_motion;
    pair.photometric_gain = previous.photometric_gain / reference.photometric_gain;  // each to the map's exposure
}
