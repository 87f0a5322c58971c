// A study as a picture: error against time, drawn by gnuplot, which is a program of its own and may be missing.
//
//   Result<Drawn> drawn = draw_svg(result, "out/rays");     // writes out/rays.gp, runs gnuplot, which writes out/rays.svg
#pragma once

#include <carom/studies/accuracy/study.hpp>

#include <string>

namespace carom::accuracy {

/// The script that draws a study: both axes logarithmic, a colour for each of those who took part, the front as a line. Errors of
/// zero stand on the lower edge and failures on the upper one, for a logarithm has no place for either.
/// @param svg  the file that gnuplot is to write.
[[nodiscard]] std::string plot_script(const StudyResult& result, const std::string& svg);

enum class Drawn : unsigned char { Yes, NoGnuplot };

/// @return the text as a string of gnuplot's, on one line.
[[nodiscard]] std::string quoted_for_gnuplot(std::string text);

/// Writes `script` into `stem`.gp and has gnuplot run it; that is to write `stem`.svg. Returns as draw_svg does.
[[nodiscard]] Result<Drawn> run_script(const std::string& script, const std::string& stem);

/// Writes `stem`.gp and has gnuplot draw `stem`.svg from it.
/// @return NoGnuplot where there is no such program on the PATH; the script is there all the same, to be run elsewhere. Io: the
/// script cannot be written, or gnuplot failed; what it said went to stderr.
[[nodiscard]] Result<Drawn> draw_svg(const StudyResult& result, const std::string& stem);

}  // namespace carom::accuracy
