// Debug frames as a series of .vtp files with a .pvd that ParaView opens.
//
//   VtpSeriesWriter series("out/demo");                    // out/demo/frames.pvd and out/demo/frames/*.vtp
//   for (...) if (Status s = series.add(make_debug_frame(world), time); !s) return s;
//   Status s = series.finish();
//
// Each layer of each frame is a part of its own, one file `<layer>_<frame>.vtp`, named after the layer; empty layers have
// none, and a layer that is as in the frame before is not written again. Cells are vertices (points and texts), lines and
// triangles; arrays:
//   cells   color (RGBA, uint8), body_slot, body_generation (uint32; 0 is no body)
//   points  Normals (float; triangles only, else zero), text (string; in layers with text only)
//   field   origin (3 doubles: the world position that the points are relative to [m])
#pragma once

#include <carom/core/result.hpp>
#include <carom/viz/debug_frame.hpp>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace carom {

/// @return how many points the layer has in a file: its points and texts, two for each line, and its vertices.
[[nodiscard]] std::size_t vtp_point_count(const DebugLayer& layer) noexcept;

/// Writes one series. Files of an earlier series of that name are replaced one by one; those beyond its end stay.
class VtpSeriesWriter {
public:
    /// @param directory  made with its parents by the first add() where it is missing.
    /// @param name       of the .pvd and of the folder of .vtp files beside it.
    explicit VtpSeriesWriter(std::string directory, std::string name = "frames");
    ~VtpSeriesWriter();
    VtpSeriesWriter(VtpSeriesWriter&&) noexcept;
    VtpSeriesWriter& operator=(VtpSeriesWriter&&) noexcept;

    /// Adds the frame at `time` [s], finite and not before the last one's.
    /// @return Io with the path; what validate(frame) says; NotFinite or InvalidArgument (time, or after finish()). A frame that
    /// failed is not part of the series.
    [[nodiscard]] Status add(const DebugFrame& frame, double time);

    /// Writes the .pvd. Nothing can be added afterwards.
    /// @return Io with the path; Empty where no frame was added.
    [[nodiscard]] Status finish();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// One entry of a .pvd as read back.
struct VtpPart {
    double time = 0.0;        ///< [s]
    std::string layer{};
    std::string file{};       ///< as the .pvd names it, relative to its folder
    std::size_t points = 0;
    std::size_t vertices = 0, lines = 0, triangles = 0;  ///< cells of each kind
};

/// Reads a .pvd and every .vtp that it names, with VTK's own readers.
/// @return its entries in order; Io (a file that cannot be read), Parse (not of the format), with the path.
[[nodiscard]] Result<std::vector<VtpPart>> read_vtp_series(const std::string& pvd_path);

}  // namespace carom
