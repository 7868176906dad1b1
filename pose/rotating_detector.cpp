#include "pose/rotating_detector.hpp"

#include <string>
#include <utility>

#include "pose/rotation_search.hpp"

namespace posefusion {
namespace {

People detect_rotated(JointDetector& detector, const ColorImage& color, ImageRotation rotation) {
    if (rotation == ImageRotation::None) return detector.detect(color);
    return rotated_back(detector.detect(rotated(color, rotation)), rotation, color.width(), color.height());
}

std::string description_of(const JointDetector& detector, ImageRotation rotation) {
    if (rotation == ImageRotation::None) return detector.description();
    return detector.description() + ", images rotated by " + std::to_string(degrees_of(rotation)) + " degrees";
}

class FixedRotation final : public JointDetector {
public:
    FixedRotation(std::unique_ptr<JointDetector> detector, ImageRotation rotation)
        : detector_(std::move(detector)), rotation_(rotation) {}
    People detect(const ColorImage& color) override { return detect_rotated(*detector_, color, rotation_); }
    std::string description() const override { return description_of(*detector_, rotation_); }

private:
    std::unique_ptr<JointDetector> detector_;
    ImageRotation rotation_;
};

class BestRotation final : public JointDetector {
public:
    explicit BestRotation(std::unique_ptr<JointDetector> detector) : detector_(std::move(detector)) {}

    People detect(const ColorImage& color) override {
        People people = detect_rotated(*detector_, color, search_.present());
        const Sighting seen = sighting_of(people);
        const std::optional<ImageRotation> other = search_.other_to_try(seen);
        if (!other) return people;
        People people_there = detect_rotated(*detector_, color, *other);
        return search_.compare(seen, sighting_of(people_there)) ? people_there : people;
    }
    std::string description() const override { return description_of(*detector_, search_.present()); }
    ByteArray state() const override { return search_.state(); }
    void restore(std::span<const std::byte> state) override { search_.restore(state); }

private:
    std::unique_ptr<JointDetector> detector_;
    RotationSearch search_;
};

}  // namespace

std::unique_ptr<JointDetector> make_rotating_detector(std::unique_ptr<JointDetector> detector,
                                                      std::optional<ImageRotation> rotation) {
    if (!rotation) return std::make_unique<BestRotation>(std::move(detector));
    if (*rotation == ImageRotation::None) return detector;
    return std::make_unique<FixedRotation>(std::move(detector), *rotation);
}

}  // namespace posefusion
