// The .vtp series: what was written is what VTK reads back.
#include "scratch.hpp"

#include <carom/viz/vtk/vtp_series.hpp>

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <set>

namespace carom {
namespace {

void overwrite(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::trunc) << text; }

TEST(VtpSeries, ReadsBackWithTheSamePointsAndCells) {
    const ScratchFolder folder("series");
    VtpSeriesWriter series(folder / "new/place");
    std::vector<DebugFrame> frames;
    for (int k = 0; k < 3; ++k) {
        DebugFrame frame = small_scene({10.0 * k, 0.0, 0.0});
        for (int i = 0; i < k; ++i) frame.layers[1].points.push_back({{0.0f, 1.0f, 0.0f}, kGreen, {}});
        frame.layers.push_back({.name = "empty"});
        frames.push_back(frame);
        ASSERT_TRUE(series.add(frame, 0.1 * k));
    }
    ASSERT_TRUE(series.finish());
    const auto parts = read_vtp_series(folder / "new/place/frames.pvd");
    ASSERT_TRUE(parts) << parts.error().message;
    ASSERT_EQ(parts->size(), 9u);  // three layers with something in them
    for (std::size_t i = 0; i < parts->size(); ++i) {
        const VtpPart& part = (*parts)[i];
        const DebugLayer* layer = frames[i / 3].find(part.layer);
        ASSERT_NE(layer, nullptr) << part.layer;
        EXPECT_EQ(part.time, 0.1 * static_cast<double>(i / 3));  // 17 digits: exact
        EXPECT_EQ(part.points, vtp_point_count(*layer));
        EXPECT_EQ(part.vertices, layer->points.size() + layer->texts.size());
        EXPECT_EQ(part.lines, layer->lines.size());
        EXPECT_EQ(part.triangles, layer->triangles.size());
        EXPECT_EQ(part.file.rfind("frames/" + part.layer + "_", 0), 0u) << part.file;
    }
}

TEST(VtpSeries, UnchangedLayersAreWrittenOnce) {
    const ScratchFolder folder("unchanged");
    VtpSeriesWriter series(folder.path(), "run");
    DebugFrame frame = small_scene();
    for (int k = 0; k < 4; ++k) {
        frame.layers[1].points[0].position.y += 0.5f;
        ASSERT_TRUE(series.add(frame, k));
    }
    ASSERT_TRUE(series.finish());
    const auto parts = read_vtp_series(folder / "run.pvd");
    ASSERT_TRUE(parts);
    ASSERT_EQ(parts->size(), 12u);
    std::set<std::string> shapes, contacts;
    for (const VtpPart& part : *parts) {
        if (part.layer == "shapes") shapes.insert(part.file);
        if (part.layer == "contacts") contacts.insert(part.file);
    }
    EXPECT_EQ(shapes.size(), 1u);
    EXPECT_EQ(contacts.size(), 4u);
}

TEST(VtpSeries, MisuseAndUnwritablePlacesAreTyped) {
    const ScratchFolder folder("misuse");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    VtpSeriesWriter series(folder.path());
    EXPECT_EQ(series.finish().error().code, ErrorCode::Empty);
    EXPECT_EQ(series.add(small_scene(), nan).error().code, ErrorCode::NotFinite);
    DebugFrame broken = small_scene();
    broken.layers[0].name = "../escape";
    EXPECT_EQ(series.add(broken, 0.0).error().code, ErrorCode::InvalidArgument);
    ASSERT_TRUE(series.add(small_scene(), 1.0));
    EXPECT_EQ(series.add(small_scene(), 0.5).error().code, ErrorCode::InvalidArgument);
    ASSERT_TRUE(series.finish());
    EXPECT_EQ(series.add(small_scene(), 2.0).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(series.finish().error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(read_vtp_series(folder / "frames.pvd").value().size(), 3u);

    EXPECT_EQ(VtpSeriesWriter(folder.path(), "a/b").add(small_scene(), 0.0).error().code, ErrorCode::InvalidArgument);
    overwrite(folder / "file", "in the way");
    VtpSeriesWriter blocked(folder / "file");
    const Status status = blocked.add(small_scene(), 0.0);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::Io);
    EXPECT_NE(status.error().message.find(folder / "file"), std::string::npos);
    EXPECT_EQ(blocked.finish().error().code, ErrorCode::Empty);  // the failed frame is not part of it
    std::filesystem::create_directories(folder / "taken/frames/shapes_000000.vtp");
    EXPECT_EQ(VtpSeriesWriter(folder / "taken").add(small_scene(), 0.0).error().code, ErrorCode::Io);
    VtpSeriesWriter no_index(folder / "index");
    ASSERT_TRUE(no_index.add(small_scene(), 0.0));
    std::filesystem::create_directories(folder / "index/frames.pvd");
    EXPECT_EQ(no_index.finish().error().code, ErrorCode::Io);
}

TEST(VtpSeries, DamagedFilesAreTyped) {
    const ScratchFolder folder("damaged");
    EXPECT_EQ(read_vtp_series(folder / "none.pvd").error().code, ErrorCode::Io);
    EXPECT_EQ(read_vtp_series(folder.path()).error().code, ErrorCode::Io);
    overwrite(folder / "a.pvd", "not xml");
    EXPECT_EQ(read_vtp_series(folder / "a.pvd").error().code, ErrorCode::Parse);
    overwrite(folder / "a.pvd", "<VTKFile><Collection><DataSet file=\"a.vtp\"/></Collection></VTKFile>");
    EXPECT_EQ(read_vtp_series(folder / "a.pvd").error().code, ErrorCode::Parse);  // no time
    overwrite(folder / "a.pvd", "<VTKFile><Collection><DataSet timestep=\"0\" file=\"a.vtp\"/></Collection></VTKFile>");
    EXPECT_EQ(read_vtp_series(folder / "a.pvd").error().code, ErrorCode::Io);
    overwrite(folder / "a.vtp", "not xml either");
    EXPECT_EQ(read_vtp_series(folder / "a.pvd").error().code, ErrorCode::Parse);
}

TEST(VtpSeries, NeedsNoDisplay) {
    const DisplayIs none(nullptr);
    const ScratchFolder folder("no_display");
    VtpSeriesWriter series(folder.path());
    ASSERT_TRUE(series.add(small_scene(), 0.0));
    ASSERT_TRUE(series.finish());
    EXPECT_TRUE(read_vtp_series(folder / "frames.pvd"));
}

}  // namespace
}  // namespace carom
