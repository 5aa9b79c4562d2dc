#include "lobe/scene/bind_groups.h"

#include <algorithm>

#include "lobe/error.h"
#include "lobe/scene/each_selector.h"
#include "lobe/scene/nearest_word.h"

namespace lobe {
namespace {

class GroupBinder {
 public:
  explicit GroupBinder(const MeshFile& mesh) : mesh_(mesh) {}

  void bind(Scene& scene) {
    for_each_selector(scene, [&](Selector& selector, Selects, const std::string& entry, const char* key) {
      bind(selector, entry + key);
    });
    if (!faults_.empty()) throw InputError(std::move(faults_));
  }

 private:
  void bind(Selector& selector, const std::string& place) {
    std::visit([&](auto& select) { bind_one(select, place); }, selector.value);
    if (auto* by_label = std::get_if<SelectLabel>(&selector.value); by_label && !by_label->names.empty())
      selector = of_bodies(*by_label, place + "/label");
  }

  // Files of several bodies may have one name for different labels, and different names for one label.
  Selector of_bodies(const SelectLabel& select, const std::string& place) {
    SelectAnyOf any;
    if (!select.labels.empty()) any.parts.push_back({SelectLabel{select.labels}});
    for (const std::string& name : select.names) {
      const std::size_t before = any.parts.size();
      for (const BodyLabelName& known : mesh_.body_label_names)
        if (known.name == name)
          any.parts.push_back({SelectAllOf{{{SelectBody{{known.body}}}, {SelectLabel{{known.label}}}}}});
      if (any.parts.size() == before) refuse(place, "label", name, labels());
    }
    return {std::move(any)};
  }
  template <class Select>
  void bind_one(Select&, const std::string&) {}  // names no group
  void bind_one(SelectAnyOf& any, const std::string& place) { bind_parts(any.parts, place + "/any_of/"); }
  void bind_one(SelectAllOf& all, const std::string& place) { bind_parts(all.parts, place + "/all_of/"); }
  void bind_one(SelectNot& negated, const std::string& place) {
    for (Selector& part : negated.part) bind(part, place + "/not");
  }
  void bind_parts(std::vector<Selector>& parts, const std::string& list) {
    for (std::size_t i = 0; i < parts.size(); ++i) bind(parts[i], list + std::to_string(i));
  }

  void bind_one(SelectSurface& select, const std::string& place) {
    select.triangles.clear();
    select.is_bound = true;
    for (const std::string& name : select.names) {
      const std::vector<const SurfaceGroup*> groups = surfaces_called(name);
      for (const SurfaceGroup* group : groups)
        select.triangles.insert(select.triangles.end(), group->triangles.begin(), group->triangles.end());
      if (groups.empty()) refuse(place + "/surface", "surface", name, surfaces());
    }
  }

  void bind_one(SelectLabel& select, const std::string& place) {
    if (mesh_.mesh.bodies.any()) return;  // of_bodies() does it
    for (const std::string& name : select.names) {
      const auto named = std::find_if(mesh_.label_names.begin(), mesh_.label_names.end(),
                                      [&](const auto& label) { return label.second == name; });
      if (named != mesh_.label_names.end())
        select.labels.push_back(named->first);
      else
        refuse(place + "/label", "label", name, labels());
    }
    select.names.clear();
  }

  // Those of this name, else of this number.
  std::vector<const SurfaceGroup*> surfaces_called(const std::string& name) const {
    std::vector<const SurfaceGroup*> named, numbered;
    for (const SurfaceGroup& group : mesh_.surfaces) {
      if (group.name == name) named.push_back(&group);
      if (std::to_string(group.number) == name) numbered.push_back(&group);
    }
    return named.empty() ? numbered : named;
  }

  std::vector<std::string> surfaces() const {
    std::vector<std::string> names;
    for (const SurfaceGroup& group : mesh_.surfaces)
      names.push_back(group.name.empty() ? std::to_string(group.number) : group.name);
    return names;
  }
  std::vector<std::string> labels() const {
    std::vector<std::string> names;
    for (const auto& [number, name] : mesh_.label_names) names.push_back(name);
    for (const BodyLabelName& known : mesh_.body_label_names) names.push_back(known.name);
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
  }

  void refuse(const std::string& place, const std::string& what, const std::string& name,
              const std::vector<std::string>& known) {
    std::string text = "the mesh's file names no " + what + " \"" + name + "\"";
    for (std::size_t i = 0; i < known.size(); ++i)
      text += (i == 0 ? "; it names \"" : ", \"") + known[i] + "\"";
    if (known.empty()) text += ", nor any other";
    const std::string nearest = nearest_word(name, known);
    if (!nearest.empty()) text += "; did you mean \"" + nearest + "\"?";
    faults_.push_back({place, text});
  }

  const MeshFile& mesh_;
  std::vector<Fault> faults_;
};

}  // namespace

void bind_groups(const MeshFile& mesh, Scene& scene) { GroupBinder(mesh).bind(scene); }

}  // namespace lobe
