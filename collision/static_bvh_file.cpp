// The file form of a static hierarchy: a header, then its nodes and leaves in the order of memory, a word before each that says which
// it is; all numbers little-endian.
#include <carom/collision/static_bvh.hpp>

#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/detail/wide_check.hpp>
#include <carom/collision/detail/wide_crowding.hpp>
#include <carom/core/hash.hpp>

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstring>
#include <utility>

namespace carom {
namespace {

constexpr std::uint64_t kMagic = 0x6876426d6f726143u;  // "CaromBvh" as bytes
constexpr std::uint32_t kVersion = 2;
constexpr std::uint32_t kNodeWord = 0x65646f6eu;  // "node"
constexpr std::uint32_t kLeafWord = 0x6661656cu;  // "leaf"
constexpr std::uint32_t kLossless = 1u, kWelded = 2u;
constexpr std::size_t kNodeSize = sizeof(WideNode) + 4;
constexpr std::size_t kLeafSize = sizeof(WideLeaf) + 4;
constexpr std::size_t kNodeLines = sizeof(WideNode) / sizeof(WideBvh::Line);
constexpr std::size_t kLeafLines = sizeof(WideLeaf) / sizeof(WideBvh::Line);

constexpr std::size_t kMostLines = 0x7fffffffu;  // what a WideRef can name

struct Header {
    std::uint64_t magic = kMagic;
    std::uint32_t version = kVersion;
    std::uint32_t width = kWidth;
    std::uint64_t nodes = 0, leaves = 0, triangles = 0;
    float scale = 1.0f;
    float lower[3] = {}, upper[3] = {};
    std::uint32_t flags = 0;  ///< kLossless, kWelded
    double cost = 0.0, built_crowding = 0.0;
    std::uint64_t checksum = 0;  ///< of all bytes of the file but these eight, which come last in the header
};
constexpr std::size_t kHeaderSize = 96;
constexpr std::size_t kChecksumAt = kHeaderSize - 8;

/// One number or an array of them, from or to little-endian bytes.
template <class T, class To>
void copy_numbers(const T* from, To* to, std::size_t count) {
    static_assert(sizeof(T) == 1 || sizeof(To) == 1);
    constexpr std::size_t kSize = std::max(sizeof(T), sizeof(To));
    std::memcpy(to, from, count * kSize);
    if constexpr (std::endian::native == std::endian::big) {
        auto* bytes = reinterpret_cast<std::byte*>(to);
        for (std::size_t k = 0; k < count; ++k) std::reverse(bytes + k * kSize, bytes + (k + 1) * kSize);
    }
}

class Writer {
public:
    explicit Writer(std::byte* to) : at_(to) {}
    template <class T>
    void numbers(const T* values, std::size_t count) {
        copy_numbers(values, at_, count);
        at_ += count * sizeof(T);
    }

private:
    std::byte* at_;
};

class Reader {
public:
    explicit Reader(const std::byte* from) : at_(from) {}
    template <class T>
    void numbers(T* values, std::size_t count) {
        copy_numbers(at_, values, count);
        at_ += count * sizeof(T);
    }

private:
    const std::byte* at_;
};

// One description of each record serves both ways.
template <class Stream, class T>
    requires std::same_as<std::remove_const_t<T>, Header>
void each_field(Stream& stream, T& h) {
    stream.numbers(&h.magic, 1), stream.numbers(&h.version, 1), stream.numbers(&h.width, 1);
    stream.numbers(&h.nodes, 1), stream.numbers(&h.leaves, 1), stream.numbers(&h.triangles, 1);
    stream.numbers(&h.scale, 1), stream.numbers(h.lower, 3), stream.numbers(h.upper, 3), stream.numbers(&h.flags, 1);
    stream.numbers(&h.cost, 1), stream.numbers(&h.built_crowding, 1), stream.numbers(&h.checksum, 1);
}
template <class Stream, class T>
    requires std::same_as<std::remove_const_t<T>, WideNode>
void each_field(Stream& stream, T& node) {
    stream.numbers(&node.bound[0][0][0], 6 * kWidth), stream.numbers(node.child, kWidth);
}
template <class Stream, class T>
    requires std::same_as<std::remove_const_t<T>, WideLeaf>
void each_field(Stream& stream, T& leaf) {
    stream.numbers(&leaf.vertex[0][0], 3 * kWidth), stream.numbers(&leaf.corner[0][0], 3 * kWidth), stream.numbers(leaf.triangle, kWidth);
    stream.numbers(&leaf.triangle_count, 1), stream.numbers(&leaf.vertex_count, 1), stream.numbers(leaf.reserved, 2);
}

std::uint64_t checksum_of(std::span<const std::byte> bytes) {
    StateHash hash;
    hash.add(bytes.first(kChecksumAt));
    hash.add(bytes.subspan(kHeaderSize));
    return hash.digest();
}

Error fault(const char* what) { return {ErrorCode::Parse, what, "StaticBvh::load"}; }

/// The header of bytes that are as long as it says and have its checksum.
Result<Header> read_header(std::span<const std::byte> bytes) {
    if (bytes.size() < kHeaderSize) return fault("shorter than a header");
    Header header;
    Reader reader(bytes.data());
    each_field(reader, header);
    if (header.magic != kMagic) return fault("not a hierarchy");
    if (header.version != kVersion) return fault("of a version that is not known here");
    if (header.width != kWidth) return fault("of another width");
    const std::size_t room = bytes.size() - kHeaderSize;
    if (header.nodes > room / kNodeSize || header.leaves > room / kLeafSize ||
        header.nodes * kNodeSize + header.leaves * kLeafSize != room) {
        return fault("not as long as the header says");
    }
    if (header.nodes * kNodeLines + header.leaves * kLeafLines > kMostLines) return fault("larger than a tree can be");
    if (header.checksum != checksum_of(bytes)) return fault("the checksum is wrong");
    const bool plain = header.flags <= (kLossless | kWelded) && header.cost > 0.0 && header.built_crowding >= 1.0 &&
                       is_finite(header.cost) && is_finite(header.built_crowding);
    if (!plain) return fault("a header that no tree has");
    return header;
}

/// Nodes and leaves one after the other. @return false where a word is neither, or the counts are wrong.
bool read_lines(Reader reader, const Header& header, WideBvh& tree) {
    tree.lines.resize(header.nodes * kNodeLines + header.leaves * kLeafLines);
    std::size_t nodes = 0, leaves = 0, line = 0;
    while (nodes + leaves < header.nodes + header.leaves) {
        std::uint32_t word = 0;
        reader.numbers(&word, 1);
        if (word == kNodeWord && nodes < header.nodes) {
            each_field(reader, tree.node(static_cast<WideRef>(line)));
            line += kNodeLines, ++nodes;
        } else if (word == kLeafWord && leaves < header.leaves) {
            each_field(reader, tree.leaf(~static_cast<WideRef>(line)));
            line += kLeafLines, ++leaves;
        } else {
            return false;
        }
    }
    return true;
}

}  // namespace

std::vector<std::byte> StaticBvh::save() const {
    const WideBvh& tree = *wide_;
    Header header{.nodes = tree.node_count, .leaves = tree.leaf_count, .triangles = tree.triangle_count, .scale = tree.scale};
    for (int k = 0; k < 3; ++k) header.lower[k] = tree.lower[k], header.upper[k] = tree.upper[k];
    header.flags = (tree.lossless ? kLossless : 0u) | (tree.welded ? kWelded : 0u);
    header.cost = tree.sah_cost, header.built_crowding = tree.built_crowding;

    std::vector<std::byte> bytes(kHeaderSize + tree.node_count * kNodeSize + tree.leaf_count * kLeafSize);
    Writer body(bytes.data() + kHeaderSize);
    std::vector<WideRef> refs = all_refs(tree);
    std::stable_sort(refs.begin(), refs.end(), [](WideRef a, WideRef b) { return start_of(a) < start_of(b); });
    for (const WideRef ref : refs) {
        body.numbers(is_leaf(ref) ? &kLeafWord : &kNodeWord, 1);
        if (is_leaf(ref)) {
            each_field(body, tree.leaf(ref));
        } else {
            each_field(body, tree.node(ref));
        }
    }
    const auto write_header = [&] {
        Writer writer(bytes.data());
        each_field(writer, std::as_const(header));
    };
    write_header();
    header.checksum = checksum_of(bytes);
    write_header();
    return bytes;
}

Result<StaticBvh> StaticBvh::load(std::span<const std::byte> bytes) {
    const Result<Header> header = read_header(bytes);
    if (!header) return header.error();
    WideBvh tree;
    tree.node_count = header->nodes;
    tree.leaf_count = header->leaves;
    tree.triangle_count = header->triangles;
    tree.scale = header->scale;
    tree.lower = {header->lower[0], header->lower[1], header->lower[2]};
    tree.upper = {header->upper[0], header->upper[1], header->upper[2]};
    tree.lossless = (header->flags & kLossless) != 0;
    tree.welded = (header->flags & kWelded) != 0;
    tree.sah_cost = header->cost;
    tree.update_far_reach();
    tree.built_crowding = header->built_crowding;
    if (header->triangles > header->leaves * kWidth) return fault("more triangles than its leaves hold");
    if (!read_lines(Reader(bytes.data() + kHeaderSize), *header, tree)) return fault("something that is neither node nor leaf");
    if (Status status = check_wide_bvh(tree); !status) return status.error();
    tree.crowding = crowding_of(tree, all_refs(tree));
    return StaticBvh(std::move(tree));
}

}  // namespace carom
