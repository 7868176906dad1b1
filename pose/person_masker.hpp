#pragma once
#include <string>

#include "engine/core/image.hpp"

namespace posefusion {

/// Interface for your own segmentation network: colour image -> person labels. To add one, derive from this
/// class (MaskRcnn in mask_rcnn.cpp is the example), and make it in make_people_finder() (hosts/pipeline).
class PersonMasker {
public:
    virtual ~PersonMasker() = default;
    /// @return a label image of the same size: 0 static, 1..n person. Same image, same result; called for every frame.
    ///         Throws Error if the network cannot take the image.
    [[nodiscard]] virtual LabelImage mask(const ColorImage& color) = 0;
    [[nodiscard]] virtual std::string description() const = 0;  ///< network and runtime, for reports
};

}  // namespace posefusion
