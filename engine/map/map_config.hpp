#pragma once
namespace posefusion {

struct MapConfig {
    int index_map_scale = 2;  ///< cells per pixel and axis: 2 = 4x super-sampled
    float association_depth =
        0.05f;  ///< largest distance between a pixel and its surfel along the ray, metres (ElasticFusion) ...
    float association_sigmas = 3.0f;  ///< ... or this many standard deviations of the depth noise, whichever is larger
    /// Largest angle between the normals of a pixel and its surfel, degrees; as TrackingConfig::kIcpMaxAngleDeg.
    static constexpr float kAssociationAngleDeg = 30.0f;
    float stable_confidence = 10.0f;  ///< a surfel is stable from this confidence on (ElasticFusion)
    float predict_confidence = 1.5f;  ///< surfels below this are not part of the predicted model
    float max_weight = 100.0f;        ///< limit on the weight of a surfel's running means, observations at 1 m
    /// Unstable surfels not seen for this many frames are removed (ElasticFusion).
    static constexpr int kUnstableTimeout = 20;
    float free_space_margin = 0.04f;  ///< static depth this far behind a surfel shows that it is gone, metres ...
    /// ... or by this many standard deviations of the depth noise, whichever is larger.
    static constexpr float kFreeSpaceSigmas = 4.0f;
    float free_space_decay = 0.6f;  ///< factor on the confidence of such a surfel, per frame
    float duplicate_spacing =
        0.5f;  ///< of two stable surfels of one surface closer than this many radii, one is removed; 0: never ...
    /// ... if they stem from different visits: created at least this many frames apart.
    static constexpr int kDuplicateAge = 100;
    /// Two surfels belong to one surface if they are closer than this along the normal, metres ...
    static constexpr float kDuplicateDepth = 0.005f;
    /// ... or this many standard deviations of the depth noise, whichever is larger.
    static constexpr float kDuplicateSigmas = 2.0f;
    /// Metres or radians per frame from which on observations weigh half: motion blurs them.
    static constexpr float kSpeedScale = 0.05f;
    unsigned initial_capacity = 1u << 20;  ///< surfels
    unsigned max_capacity = 8u << 20;      ///< surfels; a map that needs more ends the run with an error that says so
};

}  // namespace posefusion
