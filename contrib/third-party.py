"""Prints the licences of what is linked into the crate that is named: each text once, after the crates it is for."""

import json
import subprocess
import sys
from pathlib import Path

def metadata():
    host = subprocess.run(["rustc", "--print", "host-tuple"], check=True, capture_output=True, text=True).stdout.strip()
    command = ["cargo", "metadata", "--locked", "--format-version", "1", "--filter-platform", host]
    return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)


def linked(found, crate):
    """The packages that are linked into the crate, without those of the workspace."""
    packages = {package["id"]: package for package in found["packages"]}
    nodes = {node["id"]: node for node in found["resolve"]["nodes"]}
    is_macro = lambda id: any("proc-macro" in target["kind"] for target in packages[id]["targets"])
    todo = [id for id in found["workspace_members"] if packages[id]["name"] == crate]
    seen = set(todo)
    while todo:
        for dependency in nodes[todo.pop()]["deps"]:
            id = dependency["pkg"]
            is_normal = any(kind["kind"] is None for kind in dependency["dep_kinds"])
            if is_normal and id not in seen and not is_macro(id):
                seen.add(id)
                todo.append(id)
    kept = (packages[id] for id in seen - set(found["workspace_members"]))
    return sorted(kept, key=lambda package: (package["name"], package["version"]))


def texts(package):
    """The texts of its licence: that of MIT where there is a choice, else all."""
    folder = Path(package["manifest_path"]).parent
    names = ("LICEN", "COPYING", "NOTICE", "UNLICENSE")
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name.upper().startswith(names))
    mit = [path for path in files if "MIT" in path.name.upper()]
    is_choice = " OR " in package["license"] or "/" in package["license"]
    kept = mit if mit and is_choice else files
    return [path.read_text(errors="replace").strip() for path in kept]


def without_text(package):
    if "Apache-2.0" not in package["license"]:
        sys.exit(f"{package['name']} has no text of its licence, {package['license']}")
    return "Used under Apache-2.0: LICENSE-APACHE has its text."


def main(crate):
    owners = {}
    for package in linked(metadata(), crate):
        title = f"{package['name']} {package['version']} ({package['license']})"
        for text in texts(package) or [without_text(package)]:
            owners.setdefault(text, []).append(title)
    print(f"{crate} contains the Rust standard library (MIT OR Apache-2.0) and these crates.")
    for text, titles in owners.items():
        print("", "=" * 78, *titles, "-" * 78, text, sep="\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
