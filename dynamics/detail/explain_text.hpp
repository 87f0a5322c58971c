// The sentences of an explanation.
//
//   why.sentence = sentence_of(why);
#pragma once

#include <carom/dynamics/explain.hpp>

#include <string>

namespace carom::dynamics {

/// @return "they touch because ..." or "they do not touch because ...", of the deciding pair.
[[nodiscard]] std::string sentence_of(const ContactExplanation& why);

/// @return where in the structure that a broadphase keeps the boxes of two slots meet or do not, in one sentence.
/// @param axis  on which the boxes are farthest apart.
[[nodiscard]] std::string place_of(const Broadphase& broadphase, std::uint32_t a, std::uint32_t b, int axis);

}  // namespace carom::dynamics
