#include "hosts/io/ply.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <ostream>
#include <sstream>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/io/output_file.hpp"

namespace posefusion {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are read and written without swapping bytes");

enum class Type { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float, Double };

struct TypeName {
    const char* name;
    Type type;
};
constexpr std::array<TypeName, 16> kTypeNames{{{"char", Type::Int8},
                                               {"int8", Type::Int8},
                                               {"uchar", Type::UInt8},
                                               {"uint8", Type::UInt8},
                                               {"short", Type::Int16},
                                               {"int16", Type::Int16},
                                               {"ushort", Type::UInt16},
                                               {"uint16", Type::UInt16},
                                               {"int", Type::Int32},
                                               {"int32", Type::Int32},
                                               {"uint", Type::UInt32},
                                               {"uint32", Type::UInt32},
                                               {"float", Type::Float},
                                               {"float32", Type::Float},
                                               {"double", Type::Double},
                                               {"float64", Type::Double}}};

/// The properties of our vertices, in the order of the file: one list for writing and reading.
enum class Field { X, Y, Z, Nx, Ny, Nz, Red, Green, Blue, Radius, Confidence, Created, LastSeen };

struct Property {
    const char* type;
    const char* name;
    Field field;
};
constexpr std::array<Property, 13> kProperties{{{"float", "x", Field::X},
                                                {"float", "y", Field::Y},
                                                {"float", "z", Field::Z},
                                                {"float", "nx", Field::Nx},
                                                {"float", "ny", Field::Ny},
                                                {"float", "nz", Field::Nz},
                                                {"uchar", "red", Field::Red},
                                                {"uchar", "green", Field::Green},
                                                {"uchar", "blue", Field::Blue},
                                                {"float", "radius", Field::Radius},
                                                {"float", "confidence", Field::Confidence},
                                                {"uint", "created", Field::Created},
                                                {"uint", "last_seen", Field::LastSeen}}};
constexpr std::size_t kVertexBytes = 8 * sizeof(float) + 3 + 2 * sizeof(std::uint32_t);
constexpr std::size_t kHeaderLineLimit = 4096;

class ByteWriter {
public:
    explicit ByteWriter(char* to) : to_(to) {}
    template <class T>
    void put(T value) {
        std::memcpy(to_, &value, sizeof value);
        to_ += sizeof value;
    }

private:
    char* to_;
};

void encode(const Surfel& s, char* to) {
    ByteWriter out(to);
    for (int i = 0; i < 3; ++i) out.put(s.position[i]);
    for (int i = 0; i < 3; ++i) out.put(s.normal[i]);
    out.put(s.color.r), out.put(s.color.g), out.put(s.color.b);
    out.put(s.radius), out.put(s.confidence);
    out.put(s.created), out.put(s.last_seen);
}

std::string header_of(std::size_t count, const std::vector<std::string>& comments) {
    std::string header = "ply\nformat binary_little_endian 1.0\n";
    for (std::string comment : comments) {
        std::replace_if(
            comment.begin(), comment.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
        header += "comment " + comment + '\n';
    }
    header += "element vertex " + std::to_string(count) + '\n';
    for (const Property& p : kProperties) header += std::string("property ") + p.type + ' ' + p.name + '\n';
    return header + "end_header\n";
}

std::size_t size_of(Type type) {
    switch (type) {
        case Type::Int8:
        case Type::UInt8:
            return 1;
        case Type::Int16:
        case Type::UInt16:
            return 2;
        case Type::Int32:
        case Type::UInt32:
        case Type::Float:
            return 4;
        case Type::Double:
            return 8;
    }
    return 0;
}

template <class T>
double load_as(const char* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return static_cast<double>(value);
}

double load_number(Type type, const char* from) {
    switch (type) {
        case Type::Int8:
            return load_as<std::int8_t>(from);
        case Type::UInt8:
            return load_as<std::uint8_t>(from);
        case Type::Int16:
            return load_as<std::int16_t>(from);
        case Type::UInt16:
            return load_as<std::uint16_t>(from);
        case Type::Int32:
            return load_as<std::int32_t>(from);
        case Type::UInt32:
            return load_as<std::uint32_t>(from);
        case Type::Float:
            return load_as<float>(from);
        case Type::Double:
            return load_as<double>(from);
    }
    return 0;
}

/// Numbers outside the range of the target (a damaged file) are clamped, NaN becomes 0: the cast stays defined.
template <class T>
T to_integer(double value) {
    if (!(value > 0)) return 0;
    return static_cast<T>(std::min(value, static_cast<double>(std::numeric_limits<T>::max())));
}

void set_field(Surfel& s, Field field, double value) {
    const auto real = static_cast<float>(value);
    switch (field) {
        case Field::X:
            s.position.x() = real;
            break;
        case Field::Y:
            s.position.y() = real;
            break;
        case Field::Z:
            s.position.z() = real;
            break;
        case Field::Nx:
            s.normal.x() = real;
            break;
        case Field::Ny:
            s.normal.y() = real;
            break;
        case Field::Nz:
            s.normal.z() = real;
            break;
        case Field::Red:
            s.color.r = to_integer<std::uint8_t>(value);
            break;
        case Field::Green:
            s.color.g = to_integer<std::uint8_t>(value);
            break;
        case Field::Blue:
            s.color.b = to_integer<std::uint8_t>(value);
            break;
        case Field::Radius:
            s.radius = real;
            break;
        case Field::Confidence:
            s.confidence = real;
            break;
        case Field::Created:
            s.created = to_integer<std::uint32_t>(value);
            break;
        case Field::LastSeen:
            s.last_seen = to_integer<std::uint32_t>(value);
            break;
    }
}

/// Position of a known property in the vertices of a file.
struct Column {
    Field field;
    Type type;
    std::size_t offset;
};

struct Layout {
    std::size_t count = 0;
    std::size_t stride = 0;  ///< bytes of one vertex
    std::vector<Column> columns;
    [[nodiscard]] bool has(Field field) const {
        return std::any_of(columns.begin(), columns.end(), [&](const Column& c) { return c.field == field; });
    }
};

class HeaderReader {
public:
    HeaderReader(std::istream& in, const std::filesystem::path& file) : in_(in), file_(file) {}

    Layout read() {
        if (next_line() != "ply") fail("is not a PLY file");
        for (std::string line = next_line(); line != "end_header"; line = next_line()) parse(line);
        if (!format_seen_) fail("has no format line");
        if (elements_ == 0) fail("has no vertex element");
        for (const Field field : {Field::X, Field::Y, Field::Z})
            if (!layout_.has(field)) fail("its vertices lack x, y or z");
        return layout_;
    }

private:
    [[noreturn]] void fail(const std::string& what) const { throw Error(file_.string() + ": " + what); }

    std::string next_line() {
        std::string line;
        for (char c = 0; in_.get(c) && c != '\n';) {
            line += c;
            if (line.size() > kHeaderLineLimit) fail("is not a PLY file (endless header line)");
        }
        if (!in_) fail("ends within the PLY header");
        if (!line.empty() && line.back() == '\r') line.pop_back();
        return line;
    }

    void parse(const std::string& line) {
        std::istringstream words(line);
        std::string keyword;
        words >> keyword;
        if (keyword == "format")
            parse_format(words);
        else if (keyword == "element")
            parse_element(words);
        else if (keyword == "property" && elements_ == 1)
            parse_property(words);
    }

    void parse_format(std::istringstream& words) {
        std::string format;
        words >> format;
        if (format != "binary_little_endian")
            fail("is in PLY format '" + format + "'; only binary_little_endian is read");
        format_seen_ = true;
    }

    void parse_element(std::istringstream& words) {
        std::string name;
        words >> name;
        if (++elements_ > 1) return;  // elements after the vertices are not read
        if (name != "vertex") fail("its first element is '" + name + "', expected vertex");
        std::string count;
        words >> count;
        if (const auto number = number_of<std::size_t>(count))
            layout_.count = *number;
        else
            fail("its number of vertices is not a number");
    }

    void parse_property(std::istringstream& words) {
        std::string type_name, name;
        words >> type_name >> name;
        const auto type =
            std::find_if(kTypeNames.begin(), kTypeNames.end(), [&](const TypeName& t) { return type_name == t.name; });
        if (type == kTypeNames.end()) fail("vertex property of type '" + type_name + "' cannot be read");
        const auto known =
            std::find_if(kProperties.begin(), kProperties.end(), [&](const Property& p) { return name == p.name; });
        if (known != kProperties.end()) layout_.columns.push_back({known->field, type->type, layout_.stride});
        layout_.stride += size_of(type->type);
    }

    std::istream& in_;
    const std::filesystem::path& file_;
    Layout layout_;
    int elements_ = 0;
    bool format_seen_ = false;
};

Surfel decode(const Layout& layout, const char* from) {
    Surfel s{};
    s.position.setZero();
    s.normal.setZero();
    for (const Column& c : layout.columns) set_field(s, c.field, load_number(c.type, from + c.offset));
    return s;
}

}  // namespace

void write_ply(const std::filesystem::path& file, const std::vector<Surfel>& surfels,
               const std::vector<std::string>& comments) {
    constexpr std::size_t kChunk = 4096;  // vertices per write
    write_file_atomically(file, [&](std::ostream& out) {
        out << header_of(surfels.size(), comments);
        std::vector<char> buffer(kChunk * kVertexBytes);
        for (std::size_t begin = 0; begin < surfels.size() && out; begin += kChunk) {
            const std::size_t count = std::min(kChunk, surfels.size() - begin);
            for (std::size_t i = 0; i < count; ++i) encode(surfels[begin + i], buffer.data() + i * kVertexBytes);
            out.write(buffer.data(), static_cast<std::streamsize>(count * kVertexBytes));
        }
    });
}

std::vector<Surfel> read_ply(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in || std::filesystem::is_directory(file)) throw Error(file.string() + ": cannot be read");
    const Layout layout = HeaderReader(in, file).read();

    // Allocate no more than the file can hold, whatever its header says.
    const auto data_begin = in.tellg();
    in.seekg(0, std::ios::end);
    const auto available = static_cast<std::size_t>(in.tellg() - data_begin);
    in.seekg(data_begin);
    if (available / layout.stride < layout.count)
        throw Error(file.string() + ": is truncated: " + std::to_string(layout.count) + " vertices announced, " +
                    std::to_string(available / layout.stride) + " there");

    std::vector<Surfel> surfels;
    surfels.reserve(layout.count);
    std::vector<char> vertex(layout.stride);
    for (std::size_t i = 0; i < layout.count; ++i) {
        in.read(vertex.data(), static_cast<std::streamsize>(vertex.size()));
        surfels.push_back(decode(layout, vertex.data()));
    }
    if (!in) throw Error(file.string() + ": cannot be read to its end");
    return surfels;
}

}  // namespace posefusion
