// The studies "primitives": each primitive test in float and in double, over plain, far, tiny, huge and touching cases.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/primitive_cases.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace carom::accuracy {
namespace {

using Parts = std::vector<std::shared_ptr<const PrimitivePart>>;

Sample run_all(const Parts& parts, std::function<PartSample()> PrimitivePart::*precision) {
    Sample sample;
    double sum = 0.0;
    std::size_t count = 0;
    for (const std::shared_ptr<const PrimitivePart>& part : parts) {
        const PartSample s = (*part.*precision)();
        sample.time_s += s.time_s;
        sample.failures += s.failures;
        sum += s.error_sum;
        count += part->count;
    }
    sample.error = sum / static_cast<double>(count);
    return sample;
}

Study study_of(std::string name, const std::string& what, const Parts& parts) {
    std::size_t count = 0;
    for (const std::shared_ptr<const PrimitivePart>& part : parts) {
        count += part->count;
    }
    Study study{.name = std::move(name),
                .stage = "primitive and ray tests",
                .error = "share of wrong verdicts, and the mean relative error of t or distance otherwise",
                .unit = "1",
                .oracle = fmt::format("plain formulas in 300 bits; {} cases: {}", count, what),
                .candidates = {}};
    study.candidates.push_back(
        {"carom", {{"precision", "float"}}, [parts] { return run_all(parts, &PrimitivePart::in_float); }});
    study.candidates.push_back(
        {"carom", {{"precision", "double"}}, [parts] { return run_all(parts, &PrimitivePart::in_double); }});
    return study;
}

}  // namespace

std::vector<Study> primitive_studies(const StudyOptions& options) {
    Parts parts;
    std::vector<std::string> kinds, conditions;
    const auto note = [](std::vector<std::string>& names, const std::string& name) {
        if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    };
    for (PrimitivePart& part : primitive_parts(options.quick)) {
        note(kinds, part.kind);
        note(conditions, part.condition);
        parts.push_back(std::make_shared<const PrimitivePart>(std::move(part)));
    }
    const auto those = [&](std::string PrimitivePart::*member, const std::string& value) {
        Parts out;
        std::ranges::copy_if(parts, std::back_inserter(out), [&](const auto& part) { return (*part).*member == value; });
        return out;
    };
    std::vector<Study> studies{study_of("primitives", "all tests under all conditions", parts)};
    for (const std::string& condition : conditions) {
        studies.push_back(study_of("primitives_" + condition, "all tests, " + condition, those(&PrimitivePart::condition, condition)));
    }
    for (const std::string& kind : kinds) {
        studies.push_back(study_of("primitives_" + kind, kind + " under all conditions", those(&PrimitivePart::kind, kind)));
    }
    return studies;
}

}  // namespace carom::accuracy
