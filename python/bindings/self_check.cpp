// SPDX-License-Identifier: GPL-3.0-or-later
// Functions with which `import leaflight` checks the compiled module.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <tbb/version.h>

#include "arrays.h"
#include "bindings.h"
#include "trace/scene_tracer.h"

namespace leaflight::python {
namespace {

using Version = std::pair<int, int>;

struct Library {
  const char* name;
  Version built, loaded;
};

Version loaded_embree() {
  RTCDevice device = rtcNewDevice(nullptr);
  if (!device) return {0, 0};
  const auto part = [&](RTCDeviceProperty property) {
    return static_cast<int>(rtcGetDeviceProperty(device, property));
  };
  const Version version(part(RTC_DEVICE_PROPERTY_VERSION_MAJOR),
                        part(RTC_DEVICE_PROPERTY_VERSION_MINOR));
  rtcReleaseDevice(device);
  return version;
}

Version tbb_version(int interface) { return {interface / 1000, interface % 1000 / 10}; }

// Returns the libraries that the module was compiled with. The dynamic linker already checks
// OpenVDB, OpenEXR and Imath, whose symbols contain the version.
std::vector<Library> libraries() {
  return {
      {"oneTBB", tbb_version(TBB_INTERFACE_VERSION), tbb_version(TBB_runtime_interface_version())},
      {"Embree", {RTC_VERSION_MAJOR, RTC_VERSION_MINOR}, loaded_embree()},
  };
}

// Returns the first hit of a ray: ("isosurface" | "walls" | None, (x, y, z)).
py::tuple trace(const Scene<3>& scene, const Tuple<3>& origin, const Tuple<3>& direction,
                double c) {
  const SceneTracer<3> tracer(scene);
  const Vec3 d = to_vec<3>(direction);
  const Hit<3> hit = tracer.intersect(tracer.frame().point(to_vec<3>(origin)), d, c);
  if (hit.kind == HitKind::none) return py::make_tuple(py::none(), py::none());
  const Vec3 in_frame = tracer.surface_point(hit, d, c).position;
  const Vec3 p = in_frame * (1 / tracer.frame().scale) + tracer.frame().center;
  return py::make_tuple(hit.kind == HitKind::isosurface ? "isosurface" : "walls",
                        py::make_tuple(p.x, p.y, p.z));
}

}  // namespace

void bind_self_check(py::module_& module) {
  module.def(
      "libraries",
      [] {
        py::list result;
        for (const Library& l : libraries()) {
          result.append(py::make_tuple(l.name, l.built, l.loaded));
        }
        return result;
      },
      "Returns [(name, version of the headers, loaded version), ...]; versions are (major,\n"
      "minor).");
  module.def(
      "trace", &trace, py::arg("scene"), py::arg("origin"), py::arg("direction"), py::arg("c"),
      "Returns the first hit of a ray: (\"isosurface\", \"walls\" or None, (x, y, z) or None).");
}

}  // namespace leaflight::python
