// Structures that C++ and GLSL share byte by byte (std430): this file is compiled by both.
// C++ includes it through engine/vulkan/shared_types.hpp, which defines uint and vec4.
#ifndef POSEFUSION_SHARED_TYPES_H
#define POSEFUSION_SHARED_TYPES_H
#include "shared_constants.h"

// Everything a kernel needs to know about the camera, the frame and the configuration. Units as in slam_config.hpp.
struct Params {
    float fx, fy, cx, cy;  // pixels, full resolution; pixel centres at whole numbers
    uint width, height;
    uint frame;            // 0 = first frame
    uint active_since;     // surfels last seen in this frame or later are the active model, the others the inactive one
    uint inactive_only;    // 1: the prediction shows the inactive model instead of the active one
    uint dilation;         // person masks grow by this, pixels (at most 31)

    float depth_min, depth_max;
    float noise_a, noise_b, noise_c;  // sigma(z) = a + b (z - c)^2
    float lateral_noise;              // pixels
    float noise_floor;                // metres, calibration error that averaging does not remove
    float bilateral_space;            // 1 / (2 sigma^2), 1/pixels^2
    float bilateral_range;            // 1 / (2 k^2), k in sigmas of depth noise

    float icp_enabled;                // 0 or 1
    float icp_max_distance;           // metres
    float icp_min_cosine;
    float icp_robust;                 // Cauchy scale, standard deviations
    float photometric_weight;         // 0 turns the term off
    float photometric_robust;         // Cauchy scale, standard deviations
    float min_gradient;               // intensity per pixel
    float converged_rotation;         // radians
    float converged_translation;      // metres
    float min_inlier_ratio;
    float max_icp_rmse;               // metres
    float max_translation_sigma;      // metres, of the pose
    float max_rotation_sigma;         // radians
    float max_step_translation;       // metres per frame
    float max_step_rotation;          // radians per frame
    float speed_scale;                // metres or radians per frame at which the fusion weight is lowest

    float association_depth;          // metres along the ray
    float association_sigmas;         // ... or this many standard deviations, whichever is more
    float association_cosine;
    float stable_confidence;
    float predict_confidence;         // surfels below this are not predicted
    float max_weight;                 // of a surfel's running mean, observations at 1 m
    uint unstable_timeout;            // frames
    float duplicate_spacing;          // in radii of the smaller of two surfels: nearer, one of them is a duplicate
    uint duplicate_age;               // frames between the creation of two surfels of different visits, at least
    float duplicate_depth;            // metres along the normal
    float duplicate_sigmas;           // ... or this many standard deviations, whichever is more
    float free_space_margin;          // metres
    float free_space_sigmas;
    float free_space_decay;           // factor on the confidence of a surfel seen through
    uint first_mover_label;           // labels from here on are things that move, below it people; or NO_MOVERS

    float interval;                   // seconds since the frame that was tracked last
    float color_first_row, color_per_row;  // when rows of colour and depth were taken, seconds after the stamp:
    float depth_first_row, depth_per_row;  // first_row + v per_row
    float stamp_row;                  // the row that the stamp refers to, 0 (first) to 1 (last)

    float prior_share, prior_floor;   // how certain the start of tracking is: share of what the image says about the
                                      // translation, and 1/m^2; both 0: it is only a start
    float prior_x, prior_y, prior_z;  // ... of a thing around this point, in the camera of the model prediction
    float prior_radius;               // ... that is so large, metres: it turns by what moves its rim
    float steady_floor;               // how certain the expected shift of the camera is, 1/m^2; 0: nothing is expected
    float steady_share;               // ... and at least this share of what the image says on average of shifts ...
    float steady_enough;              // ... in directions of which it says less than this share of that average
    float image_over_window;          // where only a window of the sensor's image is given: diagonal over diagonal
};

// Rigid transform as the first three rows of a 4x4 matrix.
struct Pose {
    vec4 row0, row1, row2;
};

// A constant motion of the camera per second, in its own frame: `time` seconds later the pose T is T exp(time twist).
struct Twist {
    vec4 translation, rotation;  // m/s, rad/s; fourth: see where it is used
};

// What tracking keeps on the device from kernel to kernel and from frame to frame.
struct TrackingRecord {
    Pose model_live;     // estimate: live camera -> camera of the model prediction
    Pose world_model;    // camera of the model prediction -> world
    Pose world_live;     // result: live camera -> world
    Pose so3;            // estimate of the rotation-only pre-alignment
    Pose so3_best;       // ... the one with the least error so far

    Twist expected_motion;     // predicted motion up to the frame, by which its rows are corrected; translation.w = 1:
                               // known
    Twist last_motion;         // between the two previous poses; translation.w = 1: known
    Twist motion_error;        // motion of this frame relative to expected_motion, from its pose
    Twist frame_motion;        // at the stamp of the newest frame, as tracking has found it
    vec4 turn_acceleration;    // of the turn there, rad/s^2; fourth unused
    vec4 turn_offset;          // how much faster the camera turns at the stamp than between the two poses, rad/s
    vec4 turn_bias;            // mean of what was found for turn_offset, which is the fault of the map and not of the
                               // camera; the fourth of both unused
    vec4 acceleration_bias;    // the same for turn_acceleration

    vec4 exposure;             // factors on red, green and blue that bring the newest tracked frame into the exposure
                               // of the map, that of its first frame; fourth unused

    float icp_scale;           // residual scale in units of the noise model, from the previous step
    float photometric_scale;   // standard deviation of the intensity residual, from the previous step
    float photometric_gain;    // model intensity / live intensity, from the previous step; the live image is corrected
                               // by the exposure of the frame before
    float so3_error;           // RMS residual of so3_best

    uint failed;               // 1: tracking failed on this frame, pose held, no fusion
    uint iterations;           // Gauss-Newton steps made
    uint icp_inliers;          // at full resolution, last step
    uint photometric_inliers;

    uint valid_pixels;         // live pixels with static depth, full resolution
    float icp_rmse;            // metres
    float photometric_rmse;    // intensity 0..1
    float fusion_weight;       // by camera speed, 0.5..1

    float hessian[24];         // upper triangle of the last 6x6 system, row by row (21 used)
};

// Where tracking may start, besides its own pre-alignment (StartPose), and what became of it.
struct StartRecord {
    Pose model_live;           // live camera -> camera of the model prediction
    uint known;                // 1: there is one
    uint used;                 // 1: tracking started there
    float own_cost, cost;      // of the pre-alignment and of this start, if they were compared
};

// Counters of the map, on the device.
struct MapRecord {
    uint count;          // slots in use: alive and dead
    uint appended;       // by the last frame
    uint alive;          // after cleaning
    uint stable;
    uint inactive_in_view;  // stable surfels of the inactive model near what the last frame saw
    uint in_view;           // surfels of the active model where the last frame measured static depth
    uint seen_through;      // of these, those behind which it did
};

// A pixel seen by the live camera and by the model it was aligned to: a candidate for a loop constraint.
struct LoopSample {
    vec4 point;      // live, camera frame, metres; w = depth of the model at the point's projection, 0 = no model there
    uint created;    // frame in which the model's surfel there was created
    uint valid;      // 1: live depth and model agree
    float live_intensity, model_intensity;  // there, smoothed, 0..1; below 0 = not known
};

// A surfel offered as a node of the deformation graph.
struct SurfelSample {
    vec4 position;   // world, metres; w = 0: dead
    uint created, last_seen, padding0, padding1;
};

// The deformation of the map (engine/loops/influence_tree.hpp). Points are (x, y, z, frame).
struct DeformNode {
    vec4 rotation;              // quaternion x y z w
    vec4 translation;           // t - (R - I) g, metres: the node takes p to p + (R - I) p + this; fourth unused
};
struct DeformBranch {
    float split;                // below it the first child, else the second
    uint link;                  // axis + DEFORM_LINK * first child (the second one follows it),
                                // or DEFORM_LEAF + DEFORM_LINK * leaf
};
struct DeformLeaf {
    vec4 low, high;             // its candidates are good for points from here to here
    uint begin, end;            // of its candidates
    uint unused0, unused1;
};
// A node that can be among the nearest of a point in a leaf. Those of a leaf are sorted by `bound`.
struct DeformCandidate {
    vec4 position_created;      // world position, metres; frames as floats are exact up to 2^24
    float last_seen;            // frame
    float bound;                // no point of the leaf is nearer than this, squared metres
    uint node;
    uint unused0;
};

// Arguments of an indirect dispatch.
struct DispatchArguments {
    uint x, y, z;
};

#endif
