#include <carom/bench/broadphase_group.hpp>

#include <carom/bench/pair_finder.hpp>
#include <carom/core/random.hpp>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <numeric>

namespace carom::bench {
namespace {

constexpr int kWarmUp = 3;

struct Peer {
    const char* name;
    std::unique_ptr<PairFinder> (*make)(std::span<const FloatAabb>);
};
constexpr std::array<Peer, 3> kPeers{{{"bullet", make_bullet_pairs}, {"fcl", make_fcl_pairs}, {"cgal", make_cgal_pairs}}};

struct Bench {
    const char* name;
    int boxes;
    int percent;        ///< that move in every frame
    bool from_scratch;  ///< against CGAL alone: the others keep a tree
    int frames;
};
constexpr std::array<Bench, 8> kBenches{{{"moving/10000/1", 10000, 1, false, 80},
                                         {"moving/10000/10", 10000, 10, false, 80},
                                         {"moving/10000/100", 10000, 100, false, 80},
                                         {"moving/100000/1", 100000, 1, false, 25},
                                         {"moving/100000/10", 100000, 10, false, 25},
                                         {"moving/100000/100", 100000, 100, false, 25},
                                         {"scratch/10000", 10000, 100, true, 80},
                                         {"scratch/100000", 100000, 100, true, 25}}};

// Boxes of half sizes 0.25 .. 0.75 m, spread evenly through a cube with 8/6 m³ for each; a fixed share of them moves by 0.05 m
// a frame and is turned back at the walls.
class MovingBoxes {
public:
    MovingBoxes(int count, int percent) : side_(std::cbrt(8.0 * count / 6.0)) {
        Random random(7);
        for (int i = 0; i < count; ++i) add(random);
        for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
            if (percent == 100 || random.range(0.0, 100.0) < percent) moved_.push_back(i);
        }
    }
    [[nodiscard]] std::span<const FloatAabb> boxes() const { return boxes_; }
    [[nodiscard]] std::span<const std::uint32_t> moved() const { return moved_; }
    void advance() {
        for (const std::uint32_t i : moved_) {
            for (int k = 0; k < 3; ++k) {
                centre_[i][k] += step_[i][k];
                if (centre_[i][k] < 0.0 || centre_[i][k] > side_) step_[i][k] = -step_[i][k];
            }
            boxes_[i] = {vec3(centre_[i] - half_[i]), vec3(centre_[i] + half_[i])};
        }
    }

private:
    void add(Random& random) {
        constexpr double kStep = 0.05;  // [m]
        dvec3 direction{0.0}, centre{0.0}, half{0.0};
        do {
            for (int k = 0; k < 3; ++k) direction[k] = random.range(-1.0, 1.0);
        } while (glm::length(direction) > 1.0 || glm::length(direction) < 0.1);
        for (int k = 0; k < 3; ++k) {
            centre[k] = random.range(0.0, side_);
            half[k] = random.range(0.25, 0.75);
        }
        step_.push_back(direction * (kStep / glm::length(direction)));
        centre_.push_back(centre);
        half_.push_back(half);
        boxes_.push_back({vec3(centre - half), vec3(centre + half)});
    }

    double side_;
    std::vector<dvec3> centre_, half_, step_;
    std::vector<FloatAabb> boxes_;
    std::vector<std::uint32_t> moved_;
};

struct Contender {
    std::unique_ptr<PairFinder> finder;
    double cpu_ms = 0.0;
    double false_pairs = 0.0;
};

double cpu_now() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

bool matches(const Bench& bench, const Peer& peer, const std::string& filter) {
    const bool pointless = bench.from_scratch && peer.name != std::string("cgal");
    return !pointless && fmt::format("{}/{}", bench.name, peer.name).find(filter) != std::string::npos;
}

// The pairs that overlap exactly, sorted; and the share of the others.
std::vector<ProxyPair> exact_pairs(Contender& contender, std::span<const FloatAabb> boxes) {
    std::vector<ProxyPair> pairs = contender.finder->pairs();
    std::sort(pairs.begin(), pairs.end());
    const auto found = static_cast<double>(pairs.size());
    std::erase_if(pairs, [&](const ProxyPair& pair) { return !overlaps(boxes[pair.a], boxes[pair.b]); });
    contender.false_pairs = found > 0.0 ? 1.0 - static_cast<double>(pairs.size()) / found : 0.0;
    return pairs;
}

Status compare(const Bench& bench, std::vector<Contender>& contenders, std::span<const FloatAabb> boxes) {
    const std::vector<ProxyPair> ours = exact_pairs(contenders[0], boxes);
    for (std::size_t i = 1; i < contenders.size(); ++i) {
        const std::vector<ProxyPair> theirs = exact_pairs(contenders[i], boxes);
        if (ours != theirs) {
            return Error{ErrorCode::WrongType,
                         fmt::format("Carom finds {} pairs and {} finds {}, or not the same ones", ours.size(),
                                     contenders[i].finder->name(), theirs.size()),
                         bench.name};
        }
    }
    return {};
}

Status run_bench(const Bench& bench, const std::vector<Peer>& peers, std::FILE* table, std::vector<Row>& rows) {
    MovingBoxes scene(bench.boxes, bench.percent);
    std::vector<Contender> contenders;
    contenders.push_back({bench.from_scratch ? make_carom_scratch(scene.boxes()) : make_carom_pairs(scene.boxes())});
    for (const Peer& peer : peers) contenders.push_back({peer.make(scene.boxes())});
    for (int frame = 0; frame < bench.frames; ++frame) {
        scene.advance();
        for (Contender& contender : contenders) {
            const double before = cpu_now();
            contender.finder->update(scene.boxes(), scene.moved());
            if (frame >= kWarmUp) contender.cpu_ms += cpu_now() - before;
        }
        if (frame != 0 && frame + 1 != bench.frames) continue;
        if (Status status = compare(bench, contenders, scene.boxes()); !status) return status;
    }
    const int counted = bench.frames - kWarmUp;
    for (const Contender& contender : contenders) {
        fmt::print(table, "{:<18} {:<7} {:>7} {:>9.3f} {:>8.2f}x {:>7.1f} %\n", bench.name, contender.finder->name(),
                   contender.finder->version(), contender.cpu_ms / counted, contender.cpu_ms / contenders[0].cpu_ms,
                   100.0 * contender.false_pairs);
        if (&contender == &contenders[0]) continue;
        rows.push_back({.bench = bench.name,
                        .peer = contender.finder->name(),
                        .peer_version = contender.finder->version(),
                        .threads = 1,
                        .carom_ms = contenders[0].cpu_ms / counted,
                        .peer_ms = contender.cpu_ms / counted,
                        .carom_quality = {{"false_pairs", contenders[0].false_pairs}},
                        .peer_quality = {{"false_pairs", contender.false_pairs}}});
    }
    std::fflush(table);
    return {};
}

}  // namespace

Result<std::vector<Row>> run_broadphase_group(const GroupRequest& request) {
    std::vector<Row> rows;
    bool matched = false;
    for (const Bench& bench : kBenches) {
        std::vector<Peer> peers;
        for (const Peer& peer : kPeers) {
            if (matches(bench, peer, request.filter)) peers.push_back(peer);
        }
        if (peers.empty()) continue;
        if (!matched) {
            fmt::print(request.table, "{:<18} {:<7} {:>7} {:>9} {:>9} {:>9}\n", "bench", "engine", "version", "ms", "Carom's", "false");
        }
        matched = true;
        if (Status status = run_bench(bench, peers, request.table, rows); !status) return status.error();
    }
    if (!matched) {
        return Error{ErrorCode::UnknownName, fmt::format("no row of the group matches \"{}\"", request.filter), "filter"};
    }
    return rows;
}

}  // namespace carom::bench
