// carom::studies_accuracy linked alone.
#include <carom/studies/accuracy/study.hpp>

int main() {
    carom::accuracy::Study study{.name = "one"};
    study.candidates.push_back({"carom", {}, [] { return carom::accuracy::Sample{1.0, 1e-3, 0}; }});
    const carom::accuracy::StudyResult result = carom::accuracy::measure(study);
    return result.time_to[1] == 1.0 && !result.time_to[2] ? 0 : 1;
}
