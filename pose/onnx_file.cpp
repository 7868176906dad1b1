#include "pose/onnx_file.hpp"

#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Protocol Buffers' wire format (protobuf.dev/programming-guides/encoding) with the field numbers of onnx.proto.
namespace posefusion {
namespace {

enum WireType : std::uint64_t { Varint = 0, Fixed64 = 1, Bytes = 2, Fixed32 = 5 };

struct Field {
    std::uint64_t number = 0;
    std::uint64_t value = 0;  ///< of a Varint
    std::string_view bytes;   ///< of Bytes
};

/// Reads one message field by field; stops at its end or at the first damage.
class MessageReader {
public:
    explicit MessageReader(std::string_view message) : rest_(message) {}

    std::optional<Field> next() {
        const auto key = varint();
        if (!key) return std::nullopt;
        Field field;
        field.number = *key >> 3;
        switch (*key & 7) {
            case Varint: {
                const auto value = varint();
                if (!value) return std::nullopt;
                field.value = *value;
                return field;
            }
            case Bytes: {
                const auto size = varint();
                if (!size || *size > rest_.size()) return std::nullopt;
                field.bytes = take(*size);
                return field;
            }
            case Fixed64:
                return skip(8, field);
            case Fixed32:
                return skip(4, field);
            default:
                return std::nullopt;
        }
    }

private:
    std::optional<std::uint64_t> varint() {
        std::uint64_t value = 0;
        for (int shift = 0; shift < 64 && !rest_.empty(); shift += 7) {
            const auto byte = static_cast<std::uint8_t>(take(1)[0]);
            value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
            if (byte < 0x80) return value;
        }
        return std::nullopt;
    }

    std::optional<Field> skip(std::size_t size, const Field& field) {
        if (size > rest_.size()) return std::nullopt;
        take(size);
        return field;
    }

    std::string_view take(std::size_t size) {
        const std::string_view taken = rest_.substr(0, size);
        rest_.remove_prefix(size);
        return taken;
    }

    std::string_view rest_;
};

std::vector<Field> fields(std::string_view message, std::uint64_t number) {
    std::vector<Field> found;
    MessageReader reader(message);
    while (const auto field = reader.next()) {
        if (field->number == number) found.push_back(*field);
    }
    return found;
}

std::string_view first(std::string_view message, std::uint64_t number) {
    const std::vector<Field> found = fields(message, number);
    return found.empty() ? std::string_view{} : found.front().bytes;
}

}  // namespace

InputSize declared_input_size(const std::filesystem::path& onnx) {
    constexpr std::uint64_t kModelGraph = 7, kGraphInput = 11, kValueType = 2, kTypeTensor = 1, kTensorShape = 2;
    constexpr std::uint64_t kShapeDim = 1, kDimValue = 1;
    std::ifstream file(onnx, std::ios::binary);
    const std::string model{std::istreambuf_iterator<char>(file), {}};

    const std::string_view input = first(first(model, kModelGraph), kGraphInput);
    const std::vector<Field> dims =
        fields(first(first(first(input, kValueType), kTypeTensor), kTensorShape), kShapeDim);
    if (dims.size() != 4) return {};
    const auto extent = [&](std::size_t i) {
        constexpr std::uint64_t kLargest = 1 << 16;  // pixels; anything beyond is damage
        const std::vector<Field> value = fields(dims[i].bytes, kDimValue);
        return value.empty() || value[0].value > kLargest ? 0 : static_cast<int>(value[0].value);
    };
    return {extent(3), extent(2)};
}

}  // namespace posefusion
