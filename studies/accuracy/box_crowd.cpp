#include <carom/studies/accuracy/box_crowd.hpp>

#include <carom/studies/oracle/box_pairs.hpp>

#include <algorithm>
#include <cmath>

namespace carom::accuracy {
namespace {

constexpr double kStep = 0.05;  // of a mover in a frame, along each axis at most [m]
constexpr double kBoxFrames = 8e4;
constexpr int kMostFrames = 8;
constexpr double kPairsLookedAt = 1e8;
constexpr std::size_t kColumn = 40;

std::vector<dvec3> random_edges(const CrowdSettings& settings, Random& random) {
    std::vector<dvec3> edges;
    for (std::size_t i = 0; i < settings.count; ++i) {
        const double size = std::pow(settings.size_ratio, random.range(-0.5, 0.5));
        const double x = random.range(0.5, 1.5), y = random.range(0.5, 1.5), z = random.range(0.5, 1.5);
        edges.push_back(size * dvec3{x, y, z});
    }
    return edges;
}

// How wide `axes` axes must be for `count` boxes of these edges to overlap `overlaps` others in the mean: two boxes overlap along an axis
// of length L with a chance of (a + b) / L.
double width_for(const std::vector<dvec3>& edges, std::size_t count, int axes, double overlaps) {
    Random random(77);
    double sum = 0.0;
    constexpr int kSamples = 20000;
    for (int i = 0; i < kSamples; ++i) {
        const auto n = static_cast<double>(edges.size());
        const dvec3 both = edges[static_cast<std::size_t>(random.range(0.0, n))] + edges[static_cast<std::size_t>(random.range(0.0, n))];
        double product = 1.0;
        for (int k = 0; k < axes; ++k) product *= both[k];
        sum += product;
    }
    return std::pow(static_cast<double>(count) * sum / kSamples / overlaps, 1.0 / axes);
}

}  // namespace

const char* to_string(Spread spread) noexcept {
    switch (spread) {
        case Spread::Even:
            return "even";
        case Spread::Clustered:
            return "clustered";
        case Spread::Planar:
            return "planar";
        case Spread::Stacked:
            return "stacked";
        case Spread::Line:
            return "line";
        case Spread::Diagonal:
            return "diagonal";
        case Spread::Ground:
            return "ground";
        case Spread::Coincident:
            return "coincident";
    }
    return "unknown";
}

BoxCrowd::BoxCrowd(const CrowdSettings& settings) {
    Random random(settings.seed);
    place(settings, random);
    boxes_ = rest_;
    const auto n = static_cast<double>(settings.count);
    frames_ = 2 * std::clamp(static_cast<int>(kBoxFrames / n), 1, kMostFrames / 2);
    stride_ = static_cast<std::uint32_t>(std::ceil(n * n / kPairsLookedAt));
    for (std::uint32_t i = 0; i < settings.count; ++i) {
        if (random.unit() >= settings.moving || (settings.spread == Spread::Ground && i == 0)) continue;
        movers_.push_back(i);
    }
    if (movers_.empty()) movers_.push_back(static_cast<std::uint32_t>(settings.count - 1));
    for (std::size_t i = 0; i < movers_.size(); ++i) {
        const double x = random.range(-kStep, kStep), y = random.range(-kStep, kStep), z = random.range(-kStep, kStep);
        velocity_.emplace_back(dvec3{x, y, z});
    }
}

void BoxCrowd::place(const CrowdSettings& settings, Random& random) {
    const std::size_t n = settings.count;
    const std::vector<dvec3> edges = random_edges(settings, random);
    const auto in_cube = [&](double width) {
        const double x = random.range(0.0, width), y = random.range(0.0, width), z = random.range(0.0, width);
        return dvec3{x, y, z};
    };
    const auto a_clump = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(n))));
    const int axes = settings.spread == Spread::Planar ? 2 : (settings.spread == Spread::Line ? 1 : 3);
    const double width = width_for(edges, settings.spread == Spread::Clustered ? a_clump : n, axes, settings.overlaps);
    std::vector<dvec3> clumps;
    for (std::size_t i = 0; i < a_clump; ++i) clumps.push_back(in_cube(10.0 * width * std::cbrt(static_cast<double>(a_clump))));
    const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(n) / kColumn)));
    for (std::size_t i = 0; i < n; ++i) {
        dvec3 lower{0.0}, edge = edges[i];
        switch (settings.spread) {
            case Spread::Even:
                lower = in_cube(width);
                break;
            case Spread::Clustered:
                lower = clumps[i % a_clump] + in_cube(width);
                break;
            case Spread::Planar:
                lower = in_cube(width);
                lower.z = 0.1 * lower.z / width;
                break;
            case Spread::Stacked:
                edge = dvec3{1.0};
                lower = dvec3{1.02 * static_cast<double>(i / kColumn % columns), 1.02 * static_cast<double>(i / kColumn / columns),
                              0.999 * static_cast<double>(i % kColumn)} +
                        in_cube(0.005);
                break;
            case Spread::Line:
                lower = dvec3{random.range(0.0, width), random.range(0.0, 0.1), 0.0};
                break;
            case Spread::Diagonal:
                lower = dvec3{random.range(0.0, static_cast<double>(n) * 1.5 / settings.overlaps)} + in_cube(0.1);
                break;
            case Spread::Ground:
                lower = i == 0 ? dvec3{0.0, -1.0, 0.0} : in_cube(width);
                if (i == 0) edge = dvec3{width, 1.0, width};
                break;
            case Spread::Coincident:
                edge = dvec3{1.0};
                break;
        }
        rest_.push_back({vec3(lower), vec3(lower + edge)});
    }
}

void BoxCrowd::go_to(int frame) {
    const int steps = frame < frames_ / 2 ? frame + 1 : frames_ - 1 - frame;
    for (std::size_t m = 0; m < movers_.size(); ++m) {
        const FloatAabb& from = rest_[movers_[m]];
        const vec3 by = static_cast<float>(steps) * velocity_[m];
        boxes_[movers_[m]] = {from.lower + by, from.upper + by};
    }
}

const std::vector<ProxyPair>& BoxCrowd::exact_pairs() {
    if (has_exact_) return exact_;
    has_exact_ = true;
    for (std::uint32_t a = 0; a < rest_.size(); a += stride_) {
        const std::vector<ProxyPair> row = oracle::pairs_of_row(rest_, a);
        exact_.insert(exact_.end(), row.begin(), row.end());
    }
    return exact_;
}

}  // namespace carom::accuracy
