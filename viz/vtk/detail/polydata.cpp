#include <carom/viz/vtk/detail/polydata.hpp>

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedIntArray.h>

namespace carom::detail {
namespace {

/// Collects points and cells, and knows VTK's arrays.
class Builder {
public:
    Builder() {
        points_->SetDataTypeToFloat();
        color_->SetNumberOfComponents(4);
        color_->SetName("color");
        slot_->SetName("body_slot");
        generation_->SetName("body_generation");
        normals_->SetNumberOfComponents(3);
        normals_->SetName("Normals");
        text_->SetName("text");
    }

    vtkIdType point(const vec3& p, const vec3& normal = vec3{0.0f}, const char* text = "") {
        normals_->InsertNextTuple3(static_cast<double>(normal.x), static_cast<double>(normal.y), static_cast<double>(normal.z));
        text_->InsertNextValue(text);
        return points_->InsertNextPoint(p.x, p.y, p.z);
    }
    void cell(vtkCellArray* cells, std::initializer_list<vtkIdType> ids, Color c, BodyId body) {
        cells->InsertNextCell(ids);
        const unsigned char rgba[4] = {c.r, c.g, c.b, c.a};
        color_->InsertNextTypedTuple(rgba);
        slot_->InsertNextValue(body.slot);
        generation_->InsertNextValue(body.generation);
    }
    vtkSmartPointer<vtkPolyData> finish(bool with_text) {
        auto data = vtkSmartPointer<vtkPolyData>::New();
        data->SetPoints(points_);
        data->SetVerts(vertices);
        data->SetLines(lines);
        data->SetPolys(triangles);
        data->GetCellData()->SetScalars(color_);
        data->GetCellData()->AddArray(slot_);
        data->GetCellData()->AddArray(generation_);
        if (triangles->GetNumberOfCells() > 0) data->GetPointData()->SetNormals(normals_);
        if (with_text) data->GetPointData()->AddArray(text_);
        return data;
    }

    vtkNew<vtkCellArray> vertices, lines, triangles;

private:
    vtkNew<vtkPoints> points_;
    vtkNew<vtkFloatArray> normals_;
    vtkNew<vtkUnsignedCharArray> color_;
    vtkNew<vtkUnsignedIntArray> slot_, generation_;
    vtkNew<vtkStringArray> text_;
};

}  // namespace

vtkSmartPointer<vtkPolyData> make_polydata(const DebugLayer& layer, const PolyDataParts& parts) {
    Builder out;
    if (parts.points) {
        for (const DebugPoint& p : layer.points) out.cell(out.vertices, {out.point(p.position)}, p.color, p.body);
    }
    if (parts.texts) {
        for (const DebugText& t : layer.texts) {
            out.cell(out.vertices, {out.point(t.position, vec3{0.0f}, t.text.c_str())}, t.color, t.body);
        }
    }
    if (parts.lines) {
        for (const DebugLine& line : layer.lines) {
            const vtkIdType a = out.point(line.a), b = out.point(line.b);
            out.cell(out.lines, {a, b}, line.color, line.body);
        }
    }
    if (parts.triangles) {
        vtkIdType first = -1;
        for (const DebugVertex& v : layer.vertices) {
            const vtkIdType id = out.point(v.position, v.normal);
            if (first < 0) first = id;
        }
        for (const DebugTriangle& t : layer.triangles) {
            out.cell(out.triangles, {first + t.vertices[0], first + t.vertices[1], first + t.vertices[2]}, t.color, t.body);
        }
    }
    return out.finish(parts.texts && !layer.texts.empty());
}

}  // namespace carom::detail
