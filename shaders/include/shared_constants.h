// Constants shared by C++ and GLSL: this file is compiled by both. Values that a user may set are in Params instead.
// C++ includes it through engine/vulkan/shared_types.hpp, which defines uint.
#ifndef POSEFUSION_SHARED_CONSTANTS_H
#define POSEFUSION_SHARED_CONSTANTS_H

// Invocations per workgroup of kernels that have no reason for another number.
const uint GROUP = 64u;
// Greater than any depth, distance, error or standard deviation that occurs: the initial value of a search for the
// minimum, and the value of undetermined quantities.
const float UNBOUNDED = 1e9f;

// ------------------------------------------------------------------------------------------------ geometry and noise

// Metres. Points nearer than this are not projected: no depth camera measures there, and x / z stays small.
const float NEAR_PLANE = 0.1f;
// Two depths belong to one surface if they differ by less than this many standard deviations of the depth noise ...
const float SAME_SURFACE_SIGMAS = 3.0f;
// ... plus the depth change of a slanted surface between two pixels: metres of depth per lateral metre (76 degrees).
const float STEEPEST_SLOPE = 4.0f;
// Squared length of a mean of unit normals below which it has no direction.
const float MIN_NORMAL_LENGTH2 = 1e-4f;
// Rec. 601: shares of red, green and blue in the intensity.
const float LUMA_RED = 0.299f;
const float LUMA_GREEN = 0.587f;
const float LUMA_BLUE = 0.114f;

// ------------------------------------------------------------------------------------------------------ preprocessing

const uint MASK_WORD = 32u;             // pixels per word of a bit mask
const uint LEVELS = 3u;                 // of the image pyramids: full, half and quarter resolution
const uint PIXELS_PER_INVOCATION = 4u;  // of static_depth; of bilateral, where they are the components of a vector

// The kernels of the bilateral filter are (1 - x)^2 for x < 1, x = d^2 / (2 BILATERAL_SPREAD sigma^2): with 3, they are
// close to a Gaussian of that sigma and end at 2.4 sigma.
const float BILATERAL_SPREAD = 3.0f;
// A plane fit needs this share of its window ...
const float MIN_PLANE_SHARE = 0.25f;
// ... and pixels that are not on one line: determinant of their 2x2 scatter matrix over the product of its diagonal.
const float MIN_PLANE_SPREAD = 0.02f;
// Radians. At this expected error of a fitted normal, it and that of the coarser level weigh the same.
const float TOLERABLE_NORMAL_ERROR = 0.1f;

// ----------------------------------------------------------------------------------------------------------- tracking

// The reductions of tracking: a workgroup adds up its pixels and writes one row per subgroup, of which it has room for
// as many as there can be (subgroups of one lane).
const uint REDUCTION_GROUP = 64u;     // invocations per workgroup
const uint REDUCTION_PIXELS = 16u;    // pixels per invocation
const uint REDUCTION_COLUMNS = 36u;   // floats per row
const uint REDUCTION_MAX_ROWS = 64u;  // rows per workgroup
const uint REDUCTION_PIXELS_PER_GROUP = REDUCTION_GROUP * REDUCTION_PIXELS;

// Columns of a row of track_reduce: first the 6x6 system of the step ...
const uint COLUMN_HESSIAN = 0u;               // 21: upper triangle, row by row
const uint COLUMN_GRADIENT = 21u;             // 6: right-hand side
const uint SYSTEM_COLUMNS = 27u;
// ... then what judges it.
const uint COLUMN_ICP_ABS = 27u;              // sum of |r| / sigma of the geometric term
const uint COLUMN_ICP_COUNT = 28u;            // inliers
const uint COLUMN_ICP_SQUARES = 29u;          // sum of r^2
const uint COLUMN_PHOTOMETRIC_ABS = 30u;      // sum of |r| of the photometric term
const uint COLUMN_PHOTOMETRIC_COUNT = 31u;    // inliers
const uint COLUMN_PHOTOMETRIC_SQUARES = 32u;  // sum of r^2
const uint COLUMN_LIVE = 33u;                 // live pixels with static depth
const uint COLUMN_LIVE_INTENSITY = 34u;       // sum of the live intensities, by their robust weights
const uint COLUMN_MODEL_INTENSITY = 35u;      // ... of the model's
const uint TRACK_COLUMNS = 36u;
// With TIMING: how the residuals depend on when pixels were taken (engine/tracking/sensor_timing.hpp): on the delay of
// depth, the read-out time of depth and that of colour.
const uint COLUMN_POSE_DELAY = 36u;           // 6: second derivatives with respect to the pose and the delay of depth
const uint COLUMN_POSE_DEPTH_READOUT = 42u;   // 6: the read-out time of depth
const uint COLUMN_POSE_COLOR_READOUT = 48u;   // 6: and that of colour
const uint COLUMN_TIMES = 54u;                // 4: delay^2, delay * depth readout, depth readout^2, colour readout^2
const uint COLUMN_TIMES_GRADIENT = 58u;       // 3
const uint TIMING_COLUMNS = 61u;

// Or after them, with TURN, how residuals depend on the offset of the turn: their slope is the time since the stamp
// times that in the rotation.
const uint COLUMN_POSE_TURN = 36u;      // 18: second derivatives with respect to the pose and the turn
const uint COLUMN_TURN = 54u;           // 6: upper triangle of those with respect to the turn
const uint COLUMN_TURN_GRADIENT = 60u;  // 3
// ... and on its acceleration, the slope being the square of the time times that in the rotation: twice as much.
const uint COLUMN_TRANSLATION_ACCELERATION = 63u;  // 9: with respect to the translation and the acceleration
const uint COLUMN_TURN_ACCELERATION = 72u;         // 6: upper triangle with respect to the turn and the acceleration
const uint COLUMN_ACCELERATION = 78u;              // 6: ... and with respect to the acceleration
const uint COLUMN_ACCELERATION_GRADIENT = 84u;     // 3
const uint TURN_COLUMNS = 87u;

// rad/s^2. A hand-held camera's: turning at the stamp and, in the mean, since the last pose differ by it.
const float TURN_ACCELERATION = 8.0f;
// rad/s^2. ... while its rows are read, when a hand that trembles speeds up or slows down at once.
const float ROW_ACCELERATION = 20.0f;
// Errors of neighbouring pixels are correlated: this many of half resolution count as one measurement.
const float CORRELATED_PIXELS = 25.0f;
// Share of the newest offset in its mean.
const float TURN_BIAS_SHARE = 0.2f;

// Columns of a row of so3_reduce.
const uint COLUMN_SO3_HESSIAN = 0u;   // 6: upper triangle, row by row
const uint COLUMN_SO3_GRADIENT = 6u;  // 3: right-hand side
const uint COLUMN_SO3_SQUARES = 9u;   // sum of r^2
const uint COLUMN_SO3_COUNT = 10u;    // pixels
const uint SO3_COLUMNS = 11u;

// Columns of a row of exposure_reduce.
const uint COLUMN_EXPOSURE_WEIGHT = 0u;  // sum of w
const uint COLUMN_EXPOSURE_LIVE = 1u;    // 3: sums of w times the live colour
const uint COLUMN_EXPOSURE_MODEL = 4u;   // 3: ... the model's
const uint EXPOSURE_COLUMNS = 7u;
// Exposure: side of the block of pixels of which one is taken; weight that is needed; a channel above this is clipped
// (the last steps of 8 bits, which compression spreads); largest change from the first frame, either way.
const uint EXPOSURE_BLOCK = 4u;
const float MIN_EXPOSURE_PIXELS = 50.0f;
const float CLIPPED_COLOR = 0.98f;
const float MAX_EXPOSURE = 16.0f;
// Largest change of intensity from one tracked frame to the next, either way.
const float MAX_GAIN = 2.0f;

// Dispatch arguments of tracking: one for the reduction and one for the solver, of SO(3) and of each level.
const uint SO3_SLOT = 0u;
const uint FIRST_LEVEL_SLOT = 2u;
const uint SLOTS_PER_LEVEL = 2u;
// Then those of the comparison of two starts.
const uint START_SLOT = FIRST_LEVEL_SLOT + SLOTS_PER_LEVEL * LEVELS;
const uint TRACKING_SLOTS = START_SLOT + 2u;

// Metres. A live pixel shows the model's surface, so that their colours may be compared, if their depths differ by less
// than this plus SAME_SURFACE_SIGMAS: room for the error of the pose before the first step.
const float VISIBLE_DEPTH = 0.03f;
// Iterations of the search for the pixel that saw a point: each gains two digits.
const uint SHUTTER_STEPS = 3u;
// Metres: assumed depth of pixels without a measurement, when they are moved by the motion of the camera.
const float SHUTTER_DEPTH = 2.0f;
// Scales before the first step: of the geometric residual in units of the noise model, of the intensity (0..1).
const float FIRST_ICP_SCALE = 1.0f;
const float FIRST_PHOTOMETRIC_SCALE = 0.05f;
// Limits of the estimated scales: below the minimum, rounding would count as signal; above the maximum, outliers as
// inliers.
const float MIN_ICP_SCALE = 0.5f;
const float MAX_ICP_SCALE = 4.0f;
const float MIN_PHOTOMETRIC_SCALE = 0.008f;  // two steps of an 8 bit intensity
const float MAX_PHOTOMETRIC_SCALE = 0.2f;
// Standard deviation of a normal distribution over its mean absolute value: sqrt(pi / 2).
const float SIGMA_PER_MEAN_ABS = 1.2533f;
// The pre-alignment needs this many pixels and continues while a step reduces its error to less than this share.
const float MIN_SO3_PIXELS = 100.0f;
const float SO3_IMPROVEMENT = 0.999f;
// Pixels of the full resolution, of a point at START_DEPTH (metres). Tracking that starts nearer to the truth than this
// finds it by itself: another start is not looked at.
const float MIN_START_PIXELS = 6.0f;
const float START_DEPTH = 1.5f;
// In the comparison of two starts, a live pixel that meets no surface of the model counts as one with this residual,
// standard deviations.
const float START_OUTLIER_SIGMAS = 15.0f;
// Tracking has failed if inliers are fewer than params.min_inlier_ratio of this share of the image: almost nothing
// static is in view, and the few pixels that agree prove nothing.
const float MIN_LIVE_SHARE = 0.1f;
// Weight of the observations of the fastest camera (params.speed_scale); of one at rest: 1.
const float MIN_FUSION_WEIGHT = 0.5f;

// ---------------------------------------------------------------------------------------------------------------- map

// Kernels that run once per surfel, and their dispatch arguments.
const uint SURFEL_GROUP = 256u;           // invocations per workgroup
const uint SURFELS_PER_INVOCATION = 4u;
const uint SURFELS_PER_GROUP = SURFEL_GROUP * SURFELS_PER_INVOCATION;
// Items that one invocation counts and then writes in order: keeps the order and needs no atomic counter.
const uint CHUNK = 16u;
// What prefix_sum adds up.
const uint COUNTS_OF_PIXELS = 0u;  // new surfels: the total is appended
const uint COUNTS_OF_SLOTS = 1u;   // surfels alive: the total is the number of slots after the compaction

// Components of a surfel's appearance (surfel.glsl).
const uint CREATED = 2u;
const uint LAST_SEEN = 3u;

const uint EMPTY_CELL = 0xffffffffu;  // key and index of a cell of a depth test in which nothing was drawn

// In place of a surfel in the association of a pixel.
const uint NO_SURFEL = 0xffffffffu;   // the pixel has no static depth or no normal
const uint NEW_SURFEL = 0xfffffffeu;  // the pixel sees a surface that is not in the map

// The key by which pixels compete for a surfel: the squared distance from it above, the pixel in the lower bits.
const uint OWNER_PIXEL_BITS = 22u;
const uint MAX_PIXELS = 1u << OWNER_PIXEL_BITS;
const uint NO_OWNER = 0xffffffffu;
const uint DUPLICATE_SURFEL = 0xfffffffeu;  // in place of a key: a second surfel of the same surface, to be removed

// Index map: surfels this much nearer than params.depth_min or farther than params.depth_max are kept, as a pixel with
// a depth within the limits may still be associated with them.
const float INDEX_NEARER = 0.5f;
const float INDEX_FARTHER = 1.2f;
// Cosine between a surfel's normal and the optical axis. At a greater slant (41 degrees) live normals are too noisy to
// reject an association.
const float MIN_JUDGED_COSINE = 0.75f;
// An observation or a surfel is much coarser than another if its radius is this many times as large: it does not show
// the detail of the finer one, nor does the finer one cover what it covers.
const float MUCH_COARSER = 1.5f;
// Least confidence and least weight of a new surfel: 0 would mean that it is dead.
const float MIN_NEW_CONFIDENCE = 1e-3f;
// ElasticFusion: standard deviation of the confidence's fall-off from the image centre, in half diagonals.
const float CENTRALITY_SIGMA = 0.6f;
// Diagonal of a pixel over its side: the radius of a surfel that faces the camera, so that neighbours leave no holes.
const float PIXEL_DIAGONAL = 1.41421356f;
// A slanted surfel grows to cover its pixel, at most this much.
const float MAX_SLANT_GROWTH = 2.0f;
const float MIN_SLANT_COSINE = 1e-3f;  // no division by 0; at such a slant the radius has reached its limit anyway

// Pixels. Free space is only believed if it is also seen at this distance, in enough of the four directions: together
// with the pixel itself, which counts too, at least MIN_FREE_VOTES more for it than against it.
const int FREE_SPACE_NEIGHBOUR = 2;
const int MIN_FREE_VOTES = 4;
// A surfel that is seen through dies when its confidence has decayed to less than this.
const float MIN_CONFIDENCE = 0.5f;
// An unstable surfel at a person's pixel is the person if their depths differ by less than params.free_space_margin
// plus this many standard deviations.
const float PERSON_SIGMAS = 2.0f;
// In place of the first label of things that move: labels, a byte each, are all of people.
const uint NO_MOVERS = 256u;
// Metres. An inactive model displaced by more cannot be aligned from here (Aligner): it is not counted as in view.
const float INACTIVE_NEAR = 0.30f;

// Prediction: largest radius of a disc, pixels; its neighbours cover the rest.
const float MAX_DISC_EXTENT = 12.0f;
// Standard deviations of depth by which the rim of a disc counts as farther than its centre (disc.glsl).
const float DISC_DEPTH_SIGMAS = 20.0f;
// Cosine between ray and normal below which a disc is seen from its edge, or from behind, and not hit.
const float MIN_DISC_SLOPE = 1e-3f;

// Sources of a predicted pixel, in the last byte of its colour.
const uint SOURCE_NONE = 0u;
const uint SOURCE_MAP = 1u;
const uint SOURCE_LIVE = 2u;  // no surfel was drawn there, the live frame fills in

// -------------------------------------------------------------------------------------------------------------- loops

// Pixels at which a live image is compared with the model.
const uint LOOP_GRID_WIDTH = 32u;
const uint LOOP_GRID_HEIGHT = 24u;

// DeformBranch::link: the axis of a branch, or DEFORM_LEAF, plus DEFORM_LINK times the index of what it leads to.
const uint DEFORM_LEAF = 7u;
const uint DEFORM_LINK = 8u;

#endif
