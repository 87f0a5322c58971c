// The sentences of what became of two bodies on their way.
//
//   why.sentence = sentence_of(why);
#pragma once

#include <carom/dynamics/explain_sweep.hpp>

#include <string>

namespace carom::dynamics {

/// @return what happened to A and B, of the deciding pair, with the cause.
[[nodiscard]] std::string sentence_of(const SweepExplanation& why);

/// @return the setting that would have caught a passage of that cause. @param who  "A" or "B": the one that moved farther.
[[nodiscard]] std::string remedy_of(SweepReason cause, const std::string& who);

/// @return how a passage came about, as one sentence. @param who, whom  "A" and "B", the one that moved farther first.
[[nodiscard]] std::string passage_text(const Passage& passage, const std::string& who, const std::string& whom);

}  // namespace carom::dynamics
