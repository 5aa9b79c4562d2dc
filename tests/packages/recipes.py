"""The vcpkg port and the conda recipe agree with the project: version, licence, the options of CMake, the libraries
that are looked for. recipes.py ROOT [PACKAGING] prints what does not, and ends with the number of it.

Neither vcpkg nor conda is run."""

import json
import pathlib
import re
import sys

# Of a library that CMake looks for: its name in vcpkg and in conda-forge. None: a part of the system.
LIBRARIES = {
    "CLI11": ("cli11", "cli11"), "Eigen3": ("eigen3", "eigen"), "METIS": ("metis", "metis"),
    "nlohmann_json": ("nlohmann-json", "nlohmann_json"), "pugixml": ("pugixml", "pugixml"), "TBB": ("tbb", "tbb-devel"),
    "Threads": None, "ZLIB": ("zlib", "zlib"),
}
# What a recipe decides: the parts that need more libraries, or that users of a library do not want.
DECIDED = {"BENCHMARKS", "C", "CHOLMOD", "EXAMPLES", "MESHING", "PETSC", "PICTURES", "PYTHON", "TESTS", "VIEW"}
VCPKG_TOOLS = {"vcpkg-cmake": ("vcpkg_cmake_configure", "vcpkg_cmake_install"),
               "vcpkg-cmake-config": ("vcpkg_cmake_config_fixup",)}
VCPKG_BUILT_IN = {"vcpkg_check_features", "vcpkg_copy_tools", "vcpkg_install_copyright"}


class Project:
    def __init__(self, root):
        text = (root / "CMakeLists.txt").read_text(encoding="utf-8")
        self.version = re.search(r"^project\(lobe VERSION ([0-9.]+)", text, re.M)[1]
        self.summary = re.search(r'DESCRIPTION "([^"]*)"', text)[1]
        self.options = dict(re.findall(r'^option\(LOBE_(\w+)\s+"[^"]*"\s+([^)]+)\)', text, re.M))
        self.licence = {"BSD 3-Clause License": "BSD-3-Clause"}[(root / "LICENSE").read_text().splitlines()[0]]
        lists = [path.read_text(encoding="utf-8") for path in (root / "lib").rglob("CMakeLists.txt")]
        self.libraries = {name for text in lists for name in re.findall(r"(?:find_package|lobe_find_library)\((\w+)", text)}
        config = (root / "cmake/lobeConfig.cmake.in").read_text(encoding="utf-8").split("lobeTargets.cmake")[0]
        self.of_users = set(re.findall(r"(?:find_dependency|lobe_find_library)\((\w+)", config))
        self.cmake = re.search(r"cmake_minimum_required\(VERSION ([0-9.]+)", text)[1]


def option_faults(name, text, project):
    """Of `-DLOBE_PART=ON`s."""
    chosen = re.findall(r"-DLOBE_(\w+)=(ON|OFF)\b", text)
    faults = [f"{name}: LOBE_{part} is no option of CMakeLists.txt" for part, _ in chosen if part not in project.options]
    parts = {part for part, _ in chosen}
    faults += [f"{name}: does not decide LOBE_{part}" for part in sorted(DECIDED - parts)]
    on_by_itself = {part for part, default in project.options.items() if default not in ("ON", "OFF")}
    faults += [f"{name}: does not decide LOBE_{part}, which is on in a tree of its own"
               for part in sorted(on_by_itself - parts - DECIDED)]
    if "-DCMAKE_COMPILE_WARNING_AS_ERROR=OFF" not in text:
        faults.append(f"{name}: warnings of compilers that lobe does not know are errors")
    return faults


def vcpkg_faults(folder, project):
    manifest = json.loads((folder / "vcpkg.json").read_text(encoding="utf-8"))
    port = (folder / "portfile.cmake").read_text(encoding="utf-8")
    name, faults = "vcpkg", []
    known = {"name", "version", "description", "license", "supports", "dependencies", "default-features", "features"}
    faults += [f"{name}: {key} is not a key of the port" for key in sorted(set(manifest) - known)]
    wanted = {"name": folder.name, "version": project.version, "license": project.licence, "description": project.summary}
    faults += [f'{name}: {key} is "{manifest.get(key)}", expected "{value}"' for key, value in wanted.items()
               if manifest.get(key) != value]
    features = manifest.get("features", {})
    lists = [manifest["dependencies"]] + [feature.get("dependencies", []) for feature in features.values()]
    names = [[entry if isinstance(entry, str) else entry["name"] for entry in entries] for entries in lists]
    faults += [f"{name}: dependencies are not in the order of letters" for entries in names if entries != sorted(entries)]
    hosts = {entry["name"] for entry in manifest["dependencies"] if isinstance(entry, dict) and entry.get("host")}
    faults += [f"{name}: {feature} is no feature" for feature in manifest.get("default-features", []) if feature not in features]
    faults += library_faults(name, {entry for entries in names for entry in entries} - hosts, project.libraries, 0)
    calls = set(re.findall(r"^(vcpkg_\w+)\(", port, re.M))
    for tool, functions in VCPKG_TOOLS.items():
        if calls.intersection(functions) and tool not in hosts:
            faults.append(f"{name}: {tool} has functions that the port calls, and is no dependency of the host")
    known_calls = VCPKG_BUILT_IN.union(*VCPKG_TOOLS.values())
    faults += [f"{name}: {call}() is not known" for call in sorted(calls - known_calls)]
    of_features = dict(re.findall(r"^\s+(\w+) LOBE_(\w+)\)?$", port, re.M))
    faults += [f"{name}: feature {feature} chooses no option of CMakeLists.txt" for feature in features
               if of_features.get(feature) not in project.options]
    return faults + option_faults(name, port, project)


def library_faults(name, found, libraries, manager):
    wanted = set()
    faults = [f"{name}: what {library} is called there is not known" for library in sorted(libraries - set(LIBRARIES))]
    for library in libraries & set(LIBRARIES):
        if LIBRARIES[library]:
            wanted.add(LIBRARIES[library][manager])
    faults += [f"{name}: {entry} is missing" for entry in sorted(wanted - found)]
    return faults + [f"{name}: {entry} is not needed" for entry in sorted(found - wanted)]


def yaml_section(text, *keys):
    """The lines of text below keys[0], then below keys[1] in these, …, without indentation."""
    for key in keys:
        match = re.search(rf"^{key}:[ ]*(?:#.*)?\n((?:[ ]+.*\n|\n)*)", text, re.M)
        if not match:
            return ""
        lines = match[1].splitlines()
        indentation = min(len(line) - len(line.lstrip()) for line in lines if line.strip())
        text = "".join(line[indentation:] + "\n" for line in lines)
    return text


def conda_faults(folder, project):
    recipe = (folder / "meta.yaml").read_text(encoding="utf-8")
    name, faults = "conda", []
    wanted = {("package", "version"): f'"{project.version}"', ("about", "license"): project.licence,
              ("about", "summary"): project.summary, ("source", "path"): "../.."}
    for (section, key), value in wanted.items():
        found = re.search(rf"^{key}: (.*)$", yaml_section(recipe, section), re.M)
        if not found or found[1].strip() != value:
            faults.append(f"{name}: {section}/{key} is {found[1] if found else 'missing'}, expected {value}")
    if "\t" in recipe:
        faults.append(f"{name}: a tabulator")

    def entries(part):
        return re.findall(r"^- ([\w-]+)", yaml_section(recipe, "requirements", part), re.M)

    faults += library_faults(name, set(entries("host")), project.libraries, 1)
    faults += library_faults(f"{name}, run", set(entries("run")), project.of_users, 1)
    for part in ("build", "host", "run"):
        if entries(part) != sorted(entries(part)):
            faults.append(f"{name}: {part} is not in the order of letters")
    if f"- cmake >={project.cmake}\n" not in yaml_section(recipe, "requirements", "build"):
        faults.append(f"{name}: cmake is not at least {project.cmake}")
    return faults + option_faults(name, (folder / "build.sh").read_text(encoding="utf-8"), project)


def main(root, packaging):
    project = Project(root)
    faults = vcpkg_faults(packaging / "vcpkg/lobe", project) + conda_faults(packaging / "conda", project)
    print("\n".join(faults) or "the recipes agree with the project")
    return min(len(faults), 100)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        raise SystemExit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    sys.exit(main(folder, pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else folder / "packaging"))
