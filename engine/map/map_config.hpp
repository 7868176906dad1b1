#pragma once
namespace posefusion {

struct MapConfig {
    int index_map_scale = 2;          ///< cells per pixel and axis: 2 = 4x super-sampled
    float association_depth = 0.05f;  ///< between a pixel and its surfel along the ray, metres (ElasticFusion) ...
    float association_sigmas = 3.0f;  ///< ... or this many standard deviations of the depth noise, whichever is more
    /// Between the normals of a pixel and its surfel, degrees; as TrackingConfig::kIcpMaxAngleDeg.
    static constexpr float kAssociationAngleDeg = 30.0f;
    float stable_confidence = 10.0f;  ///< a surfel is stable from this confidence on (ElasticFusion)
    float predict_confidence = 1.5f;  ///< surfels below this are not part of the predicted model
    float max_weight = 100.0f;        ///< of a surfel's running means, observations at 1 m
    int unstable_timeout = 20;        ///< unstable surfels not seen for this many frames are removed (ElasticFusion)
    float free_space_margin = 0.04f;  ///< static depth behind a surfel by this much proves it is not there, metres ...
    float free_space_sigmas = 4.0f;   ///< ... or by this many standard deviations, whichever is more
    float free_space_decay = 0.6f;    ///< factor on the confidence of such a surfel, per frame
    float duplicate_spacing =
        0.5f;  ///< of two stable surfels of one surface, nearer than this many radii, one goes; 0: both stay ...
    int duplicate_age = 100;  ///< ... if they are of different visits: created this many frames apart
    float duplicate_depth =
        0.005f;  ///< two surfels are of one surface if less than this lies between them, metres along the normal ...
    float duplicate_sigmas = 2.0f;         ///< ... or this many standard deviations, whichever is more
    float speed_scale = 0.05f;             ///< metres or radians per frame from which on fusion weighs half
    unsigned initial_capacity = 1u << 20;  ///< surfels
    unsigned max_capacity = 8u << 20;      ///< surfels; a map that needs more ends the run with an error that says so
};

}  // namespace posefusion
