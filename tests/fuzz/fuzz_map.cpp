// Saved maps, and checkpoints with the state of the segmentation in them. Hardly any random change survives their
// checksums: so a mutation changes what is in a section, and writes the table that belongs to it.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "hosts/io/input_file.hpp"
#include "hosts/io/map_file.hpp"
#include "hosts/run/checkpoint.hpp"
#include "segmentation/segmenter.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace posefusion::fuzz {
namespace {

/// A file of sections, in parts; section_file.hpp describes the layout.
struct Parts {
    struct Content {
        std::array<std::uint8_t, 8> name;
        ByteBuffer bytes;
    };
    std::array<std::uint8_t, 16> start;  // magic, kind and version
    std::vector<Content> sections;
};

template <std::size_t count>
std::array<std::uint8_t, count> take_array(ByteReader& in) {
    std::array<std::uint8_t, count> bytes;
    std::ranges::copy(in.take(count), bytes.begin());
    return bytes;
}

/// Throws Error if it is no such file.
Parts split(ByteView file) {
    ByteReader table(file, "fuzz");
    Parts parts{take_array<16>(table), {}};
    const auto count = table.take<std::uint32_t>();
    std::vector<std::uint64_t> lengths;
    for (std::uint32_t i = 0; i < count; ++i) {
        parts.sections.push_back({take_array<8>(table), {}});
        lengths.push_back(table.take<std::uint64_t>());
        (void)table.take<std::uint64_t>();  // checksum and padding
    }
    (void)table.take<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        const ByteView bytes = table.take(lengths[i]);
        parts.sections[i].bytes.assign(bytes.begin(), bytes.end());
    }
    return parts;
}

ByteBuffer joined(const Parts& parts) {
    ByteBuffer file;
    const auto put = [&](const auto& bytes) { file.insert(file.end(), std::begin(bytes), std::end(bytes)); };
    const auto put_number = [&](auto value) {
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
        put(ByteView(bytes, sizeof value));
    };
    const auto checksum = [](const ByteBuffer& bytes) {
        return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
    };
    put(parts.start);
    put_number(static_cast<std::uint32_t>(parts.sections.size()));
    for (const auto& [name, bytes] : parts.sections) {
        put(name);
        put_number(std::uint64_t{bytes.size()});
        put_number(checksum(bytes));
        put_number(std::uint32_t{0});
    }
    put_number(checksum(file));
    for (const auto& section : parts.sections) put(section.bytes);
    return file;
}

/// That of the checkpoints in the corpus; those of other runs are refused before most is read.
RunIdentity identity() {
    using namespace std::chrono_literals;
    return {"recording", {0s, 1s, 2s}, {{"scale", "1"}}};
}

/// And goes on with what was restored.
void restore_people(const ByteArray& state) {
    constexpr std::size_t kCalls = sizeof(std::uint64_t);  // stands before the state of the segmentation
    const Intrinsics camera{15, 15, 7.5f, 5.5f, kWidth, kHeight};
    if (state.size() < kCalls) return;
    const auto segmenter = make_segmenter({}, camera, {});
    segmenter->restore(std::span(state).subspan(kCalls));
    (void)segmenter->segment(ColorImage(kWidth, kHeight), DepthImage(kWidth, kHeight, 2.0f), People{},
                             Eigen::Isometry3f::Identity());
}

}  // namespace
}  // namespace posefusion::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
    using namespace posefusion;
    constexpr unsigned kWholeFile = 8;  // one mutation of so many does not care for checksums
    std::minstd_rand random(seed);
    if (random() % kWholeFile == 0) return LLVMFuzzerMutate(data, size, max_size);
    try {
        fuzz::Parts parts = fuzz::split({data, size});
        if (parts.sections.empty()) return LLVMFuzzerMutate(data, size, max_size);
        ByteBuffer& bytes = parts.sections[random() % parts.sections.size()].bytes;
        const std::size_t length = bytes.size(), room = length + max_size - std::min(size, max_size);
        bytes.resize(room);
        bytes.resize(LLVMFuzzerMutate(bytes.data(), length, room));
        const ByteBuffer file = fuzz::joined(parts);
        if (file.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
        std::ranges::copy(file, data);
        return file.size();
    } catch (const Error&) {
        return LLVMFuzzerMutate(data, size, max_size);
    }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace posefusion;
    const fuzz::MemoryFile file(data, size);
    fuzz::expect_no_more_than_an_error([&] { (void)read_map(file.path()); });
    fuzz::expect_no_more_than_an_error(
        [&] { fuzz::restore_people(read_checkpoint(file.path(), fuzz::identity()).people); });
    return 0;
}
