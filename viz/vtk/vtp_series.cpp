#include <carom/viz/vtk/vtp_series.hpp>

#include <carom/viz/vtk/detail/files.hpp>
#include <carom/viz/vtk/detail/polydata.hpp>

#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkXMLPolyDataWriter.h>

#include <cstdio>
#include <iomanip>
#include <limits>
#include <map>
#include <sstream>
#include <utility>

namespace carom {
namespace {

/// The bytes of a .vtp file. Kept in memory so that we write the file ourselves and see every failure.
std::string encode(const DebugLayer& layer, const dvec3& origin) {
    const vtkSmartPointer<vtkPolyData> data = detail::make_polydata(layer, {});
    vtkNew<vtkDoubleArray> at;
    at->SetName("origin");
    at->SetNumberOfComponents(3);
    at->InsertNextTuple3(origin.x, origin.y, origin.z);
    data->GetFieldData()->AddArray(at);
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetInputData(data);
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToLZ4();
    writer->WriteToOutputStringOn();
    return writer->Write() != 0 ? writer->GetOutputString() : std::string{};
}

std::string file_name(const std::string& layer, std::size_t frame) {
    char number[32];
    std::snprintf(number, sizeof number, "_%06zu.vtp", frame);
    return layer + number;
}

}  // namespace

std::size_t vtp_point_count(const DebugLayer& layer) noexcept {
    return layer.points.size() + layer.texts.size() + 2 * layer.lines.size() + layer.vertices.size();
}

struct VtpSeriesWriter::Impl {
    /// A layer's last file, for frames in which nothing changed.
    struct Last {
        std::string file, bytes;
    };
    struct Entry {
        double time;
        std::size_t part;
        std::string layer, file;
    };

    std::string directory, name;
    std::map<std::string, Last> last;
    std::vector<Entry> entries;
    std::size_t frames = 0;
    double time = -std::numeric_limits<double>::infinity();
    bool finished = false;

    [[nodiscard]] Status add(const DebugFrame& frame, double at);
    [[nodiscard]] std::string pvd() const;
};

Status VtpSeriesWriter::Impl::add(const DebugFrame& frame, double at) {
    if (Status s = detail::make_directory(directory + "/" + name); !s) return s;
    std::vector<Entry> added;
    for (std::size_t part = 0; part < frame.layers.size(); ++part) {
        const DebugLayer& layer = frame.layers[part];
        if (layer.empty()) continue;
        std::string bytes = encode(layer, frame.origin);
        if (bytes.empty()) return Error{ErrorCode::Io, "VTK could not encode the layer " + layer.name, "VtpSeriesWriter::add"};
        Last& before = last[layer.name];
        if (before.bytes != bytes) {
            const std::string file = name + "/" + file_name(layer.name, frames);
            if (Status s = detail::write_file(directory + "/" + file, bytes); !s) return s;
            before = {file, std::move(bytes)};
        }
        added.push_back({at, part, layer.name, before.file});
    }
    entries.insert(entries.end(), added.begin(), added.end());
    time = at;
    ++frames;
    return {};
}

std::string VtpSeriesWriter::Impl::pvd() const {
    std::ostringstream out;
    out << std::setprecision(17)
        << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>\n";
    for (const Entry& e : entries) {
        out << "    <DataSet timestep=\"" << e.time << "\" group=\"\" part=\"" << e.part << "\" name=\"" << e.layer
            << "\" file=\"" << e.file << "\"/>\n";
    }
    out << "  </Collection>\n</VTKFile>\n";
    return out.str();
}

VtpSeriesWriter::VtpSeriesWriter(std::string directory, std::string name) : impl_(std::make_unique<Impl>()) {
    impl_->directory = directory.empty() ? std::string(".") : std::move(directory);
    impl_->name = std::move(name);
}
VtpSeriesWriter::~VtpSeriesWriter() = default;
VtpSeriesWriter::VtpSeriesWriter(VtpSeriesWriter&&) noexcept = default;
VtpSeriesWriter& VtpSeriesWriter::operator=(VtpSeriesWriter&&) noexcept = default;

Status VtpSeriesWriter::add(const DebugFrame& frame, double time) {
    const char* where = "VtpSeriesWriter::add";
    if (impl_->finished) return Error{ErrorCode::InvalidArgument, "the series is finished", where};
    if (!is_finite(time)) return Error{ErrorCode::NotFinite, "the time is not finite", where};
    if (time < impl_->time) return Error{ErrorCode::InvalidArgument, "the time is before the last frame's", where};
    if (impl_->name.empty() || impl_->name.find_first_of("/\\<>&\"'") != std::string::npos) {
        return Error{ErrorCode::InvalidArgument, "the name \"" + impl_->name + "\" cannot name files and XML alike", where};
    }
    if (Status s = validate(frame); !s) return s;
    return impl_->add(frame, time);
}

Status VtpSeriesWriter::finish() {
    const char* where = "VtpSeriesWriter::finish";
    if (impl_->finished) return Error{ErrorCode::InvalidArgument, "the series is finished", where};
    if (impl_->frames == 0) return Error{ErrorCode::Empty, "the series has no frame", where};
    if (Status s = detail::write_file(impl_->directory + "/" + impl_->name + ".pvd", impl_->pvd()); !s) return s;
    impl_->finished = true;
    impl_->last.clear();
    return {};
}

}  // namespace carom
