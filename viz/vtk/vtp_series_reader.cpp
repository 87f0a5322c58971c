#include <carom/viz/vtk/vtp_series.hpp>

#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkPolyData.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUtilities.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace carom {
namespace {

/// VTK prints what it cannot read; we report it instead.
class QuietVtk {
public:
    QuietVtk() : before_(vtkObject::GetGlobalWarningDisplay()) { vtkObject::GlobalWarningDisplayOff(); }
    ~QuietVtk() { vtkObject::SetGlobalWarningDisplay(before_); }
    QuietVtk(const QuietVtk&) = delete;
    QuietVtk& operator=(const QuietVtk&) = delete;

private:
    int before_;
};

Result<std::string> read_text(const std::string& path) {
    errno = 0;
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (in && text) return text.str();
    return Error{ErrorCode::Io, "cannot read " + path + ": " + (errno != 0 ? std::strerror(errno) : "it is empty"), path};
}

Status read_part(const std::string& path, VtpPart& part) {
    if (!std::filesystem::is_regular_file(path)) return Error{ErrorCode::Io, "cannot read " + path + ": there is no such file", path};
    vtkNew<vtkXMLPolyDataReader> reader;
    if (reader->CanReadFile(path.c_str()) == 0) return Error{ErrorCode::Parse, path + " is not a .vtp file", path};
    reader->SetFileName(path.c_str());
    reader->Update();
    if (reader->GetErrorCode() != 0) return Error{ErrorCode::Parse, path + " is damaged", path};
    vtkPolyData* data = reader->GetOutput();
    part.points = static_cast<std::size_t>(data->GetNumberOfPoints());
    part.vertices = static_cast<std::size_t>(data->GetNumberOfVerts());
    part.lines = static_cast<std::size_t>(data->GetNumberOfLines());
    part.triangles = static_cast<std::size_t>(data->GetNumberOfPolys());
    return {};
}

}  // namespace

Result<std::vector<VtpPart>> read_vtp_series(const std::string& pvd_path) {
    const QuietVtk quiet;
    const Result<std::string> text = read_text(pvd_path);
    if (!text) return text.error();
    const Error broken{ErrorCode::Parse, pvd_path + " is not a .pvd file", pvd_path};
    const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromString(text->c_str()));
    if (root == nullptr || std::strcmp(root->GetName(), "VTKFile") != 0) return broken;
    vtkXMLDataElement* collection = root->FindNestedElementWithName("Collection");
    if (collection == nullptr) return broken;
    const std::string folder = std::filesystem::path(pvd_path).parent_path().string();
    std::vector<VtpPart> parts;
    for (int i = 0; i < collection->GetNumberOfNestedElements(); ++i) {
        vtkXMLDataElement* element = collection->GetNestedElement(i);
        const char* file = element->GetAttribute("file");
        const char* name = element->GetAttribute("name");
        VtpPart part;
        if (file == nullptr || element->GetScalarAttribute("timestep", part.time) == 0) return broken;
        part.file = file;
        part.layer = name != nullptr ? name : "";
        if (Status s = read_part(folder.empty() ? part.file : folder + "/" + part.file, part); !s) return s.error();
        parts.push_back(std::move(part));
    }
    return parts;
}

}  // namespace carom
