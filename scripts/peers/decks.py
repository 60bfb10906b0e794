"""How many mesh and matrix files of other projects are read, refused with a reason, or wrong.

    python scripts/peers/decks.py [--iwan PROGRAM] [--list] FILE_OR_FOLDER ...

Fetches nothing: give the paths of what you have, such as the test inputs of CalculiX or the models of pyNastran. Each mesh file is put into a
structure file with one material and handed to `iwan modes`; each file of matrices is read with its own first matrix as stiffness and mass. A
mesh that is read is compared with a plain count of its node and element lines, where the file has neither generation nor includes.
"""

import argparse
import collections
import json
import pathlib
import re
import subprocess
import tempfile

MESHES = {".inp", ".msh", ".bdf", ".nas", ".dat"}
MATRICES = {".op4", ".pch", ".mtx", ".dmig"}
MATERIAL = "[[material]]\nyoung = 2.0e5\npoisson = 0.3\ndensity = 7.8e-9\n"
SECONDS = 60


def counted(path):
    """Nodes and solid elements by counting lines; None where that would not do."""
    text = path.read_text(errors="replace")
    if path.suffix.lower() != ".inp" or re.search(r"(?im)^\*\s*(include|part|instance|ngen|ncopy|nfill|elgen|elcopy|nmap)\b", text):
        return None
    if re.search(r"(?im)^\*\s*(node|element)\b[^\n]*input\s*=", text):
        return None
    nodes = set()
    what = None
    for line in text.splitlines():
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*"):
            word = line[1:].split(",")[0].replace(" ", "").upper()
            what = "node" if word == "NODE" else None
            continue
        if what == "node":
            nodes.add(line.split(",")[0].strip())
    return len(nodes)


def structure(path, kind):
    text = json.dumps(str(path.resolve()))
    if kind == "mesh":
        return f"[mesh]\npath = {text}\n{MATERIAL}"
    return f"[matrices]\nstiffness = {text}\nmass = {text}\n"


def run(program, path, kind):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "s.toml").write_text(structure(path, kind))
        command = [program, "modes", "s.toml", "--count", "1", "--json", "--quiet", "--out", "out"]
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=SECONDS, check=False)
        except subprocess.TimeoutExpired:
            return "slow", f"over {SECONDS} s"
    message = done.stderr.strip()
    if "panicked" in message or done.returncode not in (0, 1, 2):
        return "PANIC", message
    if done.returncode == 0:
        size = json.loads(done.stdout)["size"]
        plain = counted(path) if kind == "mesh" else None
        if plain is not None and plain != size["nodes"]:
            return "WRONG", f"{size['nodes']} nodes read, {plain} counted"
        return "computed", f"{size['nodes']} nodes, {size['elements']} elements"
    # The mesh was read, but this study of it (one material, no joints) makes no sense.
    after = ("the structure cannot be computed with", "modes:", "no element holds", "node ", "inverted")
    read = done.returncode == 1 or any(f"toml: {word}" in message for word in after)
    return ("read" if read else "refused"), message


def reason(message):
    """What a message says, without names and numbers."""
    words = message.replace("\n", " ")
    words = re.sub(r".*?\.(inp|INP|bdf|BDF|dat|DAT|nas|NAS|msh|op4|pch|mtx|dmig): ", "", words)
    return re.sub(r"'[^']*'|\"[^\"]*\"|\b\d[\d.e+-]*\b", "#", words)[:110]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--iwan", default="iwan")
    arguments.add_argument("--list", action="store_true", help="one line for each file")
    arguments.add_argument("paths", nargs="+", type=pathlib.Path)
    given = arguments.parse_args()
    files = [f for p in given.paths for f in (sorted(p.rglob("*")) if p.is_dir() else [p]) if f.is_file()]
    counts, reasons = collections.Counter(), collections.Counter()
    for path in files:
        suffix = path.suffix.lower()
        kind = "mesh" if suffix in MESHES else "matrix" if suffix in MATRICES else None
        if kind is None:
            continue
        verdict, message = run(given.iwan, path, kind)
        counts[kind, verdict] += 1
        if verdict in ("refused", "read"):
            reasons[kind, verdict, reason(message)] += 1
        if given.list or verdict in ("PANIC", "WRONG", "slow"):
            print(f"{verdict:9} {path}: {message[:300]}")
    for (kind, verdict), count in sorted(counts.items()):
        print(f"{count:5} {kind} {verdict}")
    for (kind, verdict, text), count in reasons.most_common(60):
        print(f"{count:5} {kind} {verdict}: {text}")


if __name__ == "__main__":
    main()
