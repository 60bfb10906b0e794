//! `[matrices]` of structure files: one structure from several formats, and what is refused with place and remedy.
#![allow(clippy::unwrap_used, reason = "tests may panic")]
#![allow(clippy::format_push_string, reason = "files of the tests are short")]

use std::path::{Path, PathBuf};

use iwan_core::Pulse;
use iwan_fem::{Limit, NamedModes, Representation, Transient};
use iwan_input::StructureFile;

/// A folder that is taken away at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("iwan-given-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).unwrap();
    }

    fn load(&self, text: &str) -> Result<StructureFile, String> {
        self.write("structure.toml", text);
        StructureFile::load(self.0.join("structure.toml")).map_err(|error| error.to_string())
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        drop(std::fs::remove_dir_all(&self.0));
    }
}

/// Two brackets, each of two nodes with x and y, and springs inside each; the nodes 2 and 11 meet at x = 1.
const NODES: [(u64, [f64; 3]); 4] =
    [(1, [0.0, 0.0, 0.0]), (2, [1.0, 0.0, 0.0]), (11, [1.0, 0.0, 0.0]), (12, [2.0, 0.0, 0.0])];

/// Lower triangle: pairs (1, 2) and (11, 12) are tied by springs in x and y, node 1 and node 12 to the ground.
fn stiffness() -> Vec<(usize, usize, f64)> {
    let mut k = Vec::new();
    for part in [0, 4] {
        for axis in 0..2 {
            let (a, b, value) = (part + axis, part + 2 + axis, 1000.0 + 500.0 * axis as f64);
            let ground = if part == 0 { [200.0, 0.0] } else { [0.0, 300.0] };
            k.extend([(a, a, value + ground[0]), (b, a, -value), (b, b, value + ground[1])]);
        }
    }
    k
}

fn mass() -> Vec<(usize, usize, f64)> {
    (0..8).map(|row| (row, row, 1.0 + 0.25 * (row / 2) as f64)).collect()
}

fn matrix_market(entries: &[(usize, usize, f64)]) -> String {
    let mut text = format!("%%MatrixMarket matrix coordinate real symmetric\n8 8 {}\n", entries.len());
    for (i, j, v) in entries {
        text += &format!("{} {} {v}\n", i + 1, j + 1);
    }
    text
}

fn abaqus(entries: &[(usize, usize, f64)]) -> String {
    let of = |row: usize| (NODES[row / 2].0, row % 2 + 1);
    let line = |&(i, j, v): &(usize, usize, f64)| {
        let ((a, p), (b, q)) = (of(i), of(j));
        format!("{a},{p}, {b},{q}, {v:e}\n")
    };
    entries.iter().map(line).collect()
}

fn dmig(name: &str, entries: &[(usize, usize, f64)]) -> String {
    let of = |row: usize| (NODES[row / 2].0, row % 2 + 1);
    let mut text = format!("DMIG,{name},0,6,2,0\n");
    for &(i, j, v) in entries {
        let ((a, p), (b, q)) = (of(i), of(j));
        text += &format!("DMIG,{name},{b},{q},,{a},{p},{v}\n");
    }
    text
}

const ROWS: &str = "node,component\n1,x\n1,y\n2,x\n2,y\n11,x\n11,y\n12,x\n12,y\n";

fn files(folder: &Folder) {
    folder.write("k.mtx", &matrix_market(&stiffness()));
    folder.write("m.mtx", &matrix_market(&mass()));
    folder.write("rows.csv", ROWS);
    let positions: String = NODES
        .iter()
        .fold(String::new(), |text, (n, p)| text + &format!("{n}, {}, {}, {}\n", p[0], p[1], p[2]));
    folder.write("nodes.csv", &positions);
    folder.write("abaqus_k.mtx", &abaqus(&stiffness()));
    folder.write("abaqus_m.mtx", &abaqus(&mass()));
    folder.write("both.bdf", &format!("{}{}", dmig("KAAX", &stiffness()), dmig("MAAX", &mass())));
}

const MATRICES: &str = "[matrices]\nstiffness = 'k.mtx'\nmass = 'm.mtx'\nrows = 'rows.csv'\n";
/// A joint between nodes 2 and 11 in x, a tie in y by a stiff law: both by numbers of nodes.
const REST: &str = "[[joint]]\nname = 'bolt'\nface = '11'\npatch = '2'\nmotion = 'directions'\n\
    slip = [{ direction = 'x', law = { k_t = 400.0, f_s = 3.0, chi = -0.3, beta = 0.1 } }]\n\
    [[load]]\nname = 'push'\nnodes = '12'\ndirection = 'x'\n[[output]]\nname = 'tip'\nnodes = '12'\ndirection = 'x'\n";

#[test]
fn one_structure_by_three_formats() {
    let folder = Folder::new("formats");
    files(&folder);
    let tables = [
        format!("{MATRICES}coordinates = 'nodes.csv'\ntotal_mass = 5.5\n"),
        "[matrices]\nstiffness = 'abaqus_k.mtx'\nmass = 'abaqus_m.mtx'\ncoordinates = 'nodes.csv'\n"
            .to_string(),
        "[matrices]\nstiffness = 'both.bdf'\nmass = 'both.bdf'\n".to_string(),
    ];
    let mut known: Option<Vec<f64>> = None;
    for table in tables {
        let file = folder.load(&format!("{table}{REST}")).unwrap();
        let assembled = file.structure.assemble().unwrap();
        assert_eq!((assembled.unknowns(), assembled.slips().len()), (8, 1));
        let mut frequencies = assembled.modes(Limit::Stuck, 8).unwrap().frequencies();
        frequencies.extend(assembled.modes(Limit::Slipping, 8).unwrap().frequencies());
        let known = known.get_or_insert_with(|| frequencies.clone());
        assert!(
            known.iter().zip(&frequencies).all(|(a, b)| (a / b - 1.0).abs() < 1e-10),
            "{known:?} {frequencies:?}"
        );
        // Springs in y of the right part alone: masses 1.5 and 1.75, springs 1500 and 300 to the ground.
        let (k, m): ([f64; 2], [f64; 2]) = ([1500.0, 300.0], [1.5, 1.75]);
        let (p, q) = (k[0] / m[0] + (k[0] + k[1]) / m[1], k[0] * k[1] / (m[0] * m[1]));
        let lowest = (0.5 * (p - (p * p - 4.0 * q).sqrt())).sqrt() / std::f64::consts::TAU;
        assert!(frequencies.iter().any(|f| (f / lowest - 1.0).abs() < 1e-10), "{lowest} {frequencies:?}");
        let named = NamedModes::new(&file.structure, 4).unwrap();
        assert!(file.forces(&named.assembled).unwrap().iter().sum::<f64>() == 1.0);
    }
}

#[test]
fn what_does_not_fit_is_refused_with_place_and_remedy() {
    let folder = Folder::new("refused");
    files(&folder);
    let mut all = stiffness();
    all.extend(stiffness().iter().filter(|e| e.0 != e.1).map(|&(i, j, v)| (j, i, v)));
    let at = all.iter().position(|e| (e.0, e.1) == (0, 2)).unwrap();
    all[at].2 = -990.0;
    let unsymmetric = matrix_market(&all).replace("symmetric", "general");
    folder.write("unsymmetric.mtx", &unsymmetric);
    folder.write("negative.mtx", &matrix_market(&mass()).replace("3 3 1.25", "3 3 -1.25"));
    folder.write("short.csv", "1,x\n1,y\n");
    folder.write("twice.csv", &ROWS.replace("2,x", "1,x"));
    folder.write("few.csv", "1, 0, 0, 0\n2, 1, 0, 0\n");
    folder.write("doubled.csv", "1, 0, 0, 0\n2, 1, 0, 0\n2, 1, 0, 0\n11, 1, 0, 0\n12, 1, 0, 0\n");
    folder.write("other_m.mtx", "99,1, 99,1, 1.0\n");
    folder.write("rectangle.mtx", "%%MatrixMarket matrix coordinate real general\n8 7 1\n1 1 1\n");
    let table = |old: &str, new: &str| format!("{}{REST}", MATRICES.replace(old, new));
    let cases = [
        (table("k.mtx", "none.mtx"), "none.mtx: cannot be read"),
        (
            table("k.mtx", "unsymmetric.mtx"),
            "the stiffness is not symmetric: row 3 (node 2 component 1), column 1 (node 1 component 1) is -1000, and mirrored -990",
        ),
        (table("m.mtx", "negative.mtx"), "mass, row 3 (node 2, x): the diagonal entry is -1.25e0, below 0"),
        (table("rows.csv", "short.csv"), "2 rows are named, but the stiffness has 8"),
        (table("rows.csv", "twice.csv"), "row 3 is node 1 component 1, and so is row 1"),
        (table("k.mtx", "rectangle.mtx"), "the stiffness has 8 rows and 7 columns"),
        (
            table("rows = 'rows.csv'", "rows = 'rows.csv'\ncoordinates = 'few.csv'"),
            "row 5 is node 11 component 1, and that node has no position",
        ),
        (
            table("rows = 'rows.csv'", "rows = 'rows.csv'\ncoordinates = 'doubled.csv'"),
            "a node has two positions",
        ),
        (
            table("rows = 'rows.csv'", "rows = 'rows.csv'\ntotal_mass = 7.0"),
            "total_mass = 7, but the mass moves 5.5 along x",
        ),
        (table("rows = 'rows.csv'", "rows = 'rows.csv'\nstiffness_name = 'Q'"), "has no matrix of that name"),
        (
            table("rows = 'rows.csv'", "rows = 'rows.csv'\nformat = 'ansys'"),
            "format = \"ansys\" is not known; choose one of abaqus, op4",
        ),
        (
            table("rows = 'rows.csv'", "row = 'rows.csv'"),
            "unknown key `row` in [matrices]; did you mean `rows`?",
        ),
        (
            table("[matrices]", "[mesh]\npath = 'a.msh'\n[matrices]"),
            "[mesh] beside [matrices]: the matrices hold what it would say",
        ),
        (
            "[matrices]\nstiffness = 'abaqus_k.mtx'\nmass = 'other_m.mtx'\n".into(),
            "the mass has node 99 component 1, which the stiffness has not",
        ),
        (table("k.mtx", "m.mtx").replace("patch = '2'", "patch = '11'"), "both sides begin with node 11"),
        (
            table("k.mtx", "k.mtx").replace("patch = '2'", "patch = '77'"),
            "patch = \"77\": there is no node set of that name",
        ),
    ];
    for (text, expected) in cases {
        let error = folder.load(&text).unwrap_err();
        assert!(error.contains(expected) && error.contains("structure.toml"), "{error}\n{expected}");
    }
    assert!(Path::new(&folder.0).exists());
}

/// Four thousand million rows with one entry ended the program for want of memory.
#[test]
fn more_rows_than_any_memory_holds_are_refused() {
    let folder = Folder::new("rows");
    files(&folder);
    let head = "%%MatrixMarket matrix coordinate real symmetric\n4000000000 4000000000 1\n1 1 1\n";
    folder.write("k.mtx", head);
    let error = folder.load(&format!("[matrices]\nstiffness = 'k.mtx'\nmass = 'm.mtx'\n{REST}")).unwrap_err();
    let expected = "k.mtx: a matrix of 4000000000 x 4000000000 needs about 600.000 GB of memory";
    assert!(error.contains(expected) && error.contains("correct the numbers of rows"), "{error}");
}

/// A damping that gives energy back, or of another size, is refused; one that fits is read.
#[test]
fn a_damping_that_cannot_be_one_is_refused() {
    let folder = Folder::new("damping");
    files(&folder);
    folder.write("c.mtx", &matrix_market(&mass()));
    folder.write("negative.mtx", &matrix_market(&mass()).replace("3 3 1.25", "3 3 -1.25"));
    folder.write("rectangle.mtx", "%%MatrixMarket matrix coordinate real general\n8 7 1\n1 1 1\n");
    let with = |file: &str| folder.load(&format!("{MATRICES}damping = '{file}'\n{REST}"));
    let structure = with("c.mtx").unwrap().structure;
    assert_eq!(structure.given.unwrap().damping.unwrap().diagonal_entry(2), 1.25);
    for (file, expected) in [
        ("negative.mtx", "negative.mtx: row 3 (node 2 component 1) of the damping has -1.25 on its diagonal"),
        ("rectangle.mtx", "the damping has 8 rows and 7 columns"),
        ("none.mtx", "none.mtx: cannot be read"),
    ] {
        let error = with(file).unwrap_err();
        assert!(error.contains(expected) && error.contains("structure.toml"), "{error}\n{expected}");
    }
}

/// One row of a matrix of relative displacements: node 11 against node 2 along x.
const RELATIVE: &str = "%%MatrixMarket matrix coordinate real general\n2 8 4\n1 5 1\n1 3 -1\n2 6 1\n2 4 -1\n";
/// As `REST`, by rows: the joint, the load on row 7 and the output of it.
const BY_ROWS: &str = "[[joint]]\nname = 'bolt'\nrelative = 'l.mtx'\n\
    slip = [{ rows = [1], law = { k_t = 400.0, f_s = 3.0, chi = -0.3, beta = 0.1 } }]\n\
    [[load]]\nname = 'push'\nrelative = 'tip.mtx'\n[[output]]\nname = 'tip'\nrelative = 'tip.mtx'\nrow = 1\n";

fn rows_files(folder: &Folder) {
    files(folder);
    folder.write("l.mtx", RELATIVE);
    folder.write("tip.mtx", "%%MatrixMarket matrix coordinate real general\n1 8 1\n1 7 1\n");
}

/// Joint, load and output by rows of a matrix do what the same by nodes does.
#[test]
fn rows_of_a_matrix_stand_for_nodes() {
    let folder = Folder::new("by-rows");
    rows_files(&folder);
    let results = [REST, BY_ROWS].map(|rest| {
        let file = folder.load(&format!("{MATRICES}{rest}")).unwrap();
        let named = NamedModes::new(&file.structure, 4).unwrap();
        let mut frequencies = named.assembled.modes(Limit::Stuck, 8).unwrap().frequencies();
        frequencies.extend(named.assembled.modes(Limit::Slipping, 8).unwrap().frequencies());
        let task = Transient {
            dt: 1e-3,
            steps: 400,
            pulse: Pulse::Haversine { amplitude: 40.0, duration: 0.2 },
            load: file.forces(&named.assembled).unwrap(),
            initial_velocity: None,
            representation: Representation::DEFAULT_IN_A_STRUCTURE,
            outputs: file.recorded(&named, &[]).unwrap(),
        };
        let response = named.assembled.transient(&task).unwrap();
        (frequencies, response.outputs[0].displacement.clone(), response.slips[0].slip.clone())
    });
    let close = |a: &[f64], b: &[f64]| {
        let size = a.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!(size > 0.0 && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * size), "{a:?}\n{b:?}");
    };
    let [nodes, rows] = &results;
    close(&nodes.0, &rows.0);
    close(&nodes.1, &rows.1);
    close(&nodes.2, &rows.2);
}

/// A node without rows moves as the recovery matrix says: half way between nodes 11 and 12.
#[test]
fn outputs_are_recovered() {
    let folder = Folder::new("recovery");
    rows_files(&folder);
    folder.write(
        "otm.mtx",
        "%%MatrixMarket matrix coordinate real general\n3 8 4\n1 5 0.5\n1 7 0.5\n2 8 1\n3 5 1\n",
    );
    // Row 3 is one that the matrices have, and is left out.
    folder.write("otm.csv", "500,x\n500,y\n11,x\n");
    let recovery = "recovery = 'otm.mtx'\nrecovery_rows = 'otm.csv'\n";
    let output = "[[output]]\nname = 'inside'\nnodes = '500'\ndirection = 'x'\n";
    let file = folder.load(&format!("{MATRICES}{recovery}{REST}{output}")).unwrap();
    let named = NamedModes::new(&file.structure, 4).unwrap();
    let outputs = file.recorded(&named, &[]).unwrap();
    let at = |node: &str| named.assembled.gauge(node, [1.0, 0.0, 0.0]).unwrap();
    // Sets are made of the numbers that the file names: 2, 11 and 12 are ends of the joint and the load.
    let (left, right) = (at("11"), at("12"));
    for ((inside, a), b) in outputs[1].coefficients.iter().zip(left).zip(right) {
        assert_eq!(*inside, 0.5 * (a + b));
    }
}

#[test]
fn rows_that_cannot_be_meant_are_refused() {
    let folder = Folder::new("rows-refused");
    rows_files(&folder);
    folder.write("turned.mtx", &RELATIVE.replace("1 3 -1", "1 3 1"));
    folder.write("narrow.mtx", "%%MatrixMarket matrix coordinate real general\n1 7 1\n1 7 1\n");
    folder.write("tall.mtx", "%%MatrixMarket matrix coordinate real general\n8 2 1\n1 1 1\n");
    folder.write("twice.mtx", &RELATIVE.replace("2 6 1\n2 4 -1", "2 5 2\n2 3 -2"));
    folder.write("empty.mtx", &RELATIVE.replace("1 5 1\n1 3 -1", "2 5 0\n2 3 0"));
    let table = |old: &str, new: &str| format!("{MATRICES}{}", BY_ROWS.replace(old, new));
    let cases = [
        (
            table("l.mtx", "turned.mtx"),
            "moving everything by 1 along x moves its relative displacement by 2e0",
        ),
        (table("l.mtx", "narrow.mtx"), "1 rows and 7 columns, but stiffness and mass have 8 rows"),
        (table("l.mtx", "tall.mtx"), "transpose it: give a column for each row"),
        (table("l.mtx", "empty.mtx"), "row 1 of the matrix is all 0"),
        (table("l.mtx", "none.mtx"), "none.mtx: cannot be read"),
        (table("rows = [1]", "rows = [3]"), "rows = 3: the matrix has the rows 1 to 2"),
        (table("rows = [1]", "rows = [1, 1]"), "row 1 slips twice"),
        (table("rows = [1]", "direction = 'x'"), "direction in a joint by rows"),
        (table("row = 1", "row = 1.5"), "row = 1.5: the matrix has the rows 1 to 1"),
        (table("row = 1", "nodes = '12'"), "nodes beside relative"),
        (table("relative = 'tip.mtx'\nrow = 1", "relative = 'l.mtx'"), "the matrix has 2 rows"),
        (table("relative = 'l.mtx'", "relative = 'l.mtx'\nface = '2'"), "face beside relative"),
        (format!("{MATRICES}recovery = 'tip.mtx'\n{REST}"), "tip.mtx does not say what its rows are"),
        (
            format!("{MATRICES}recovery = 'l.mtx'\nrecovery_rows = 'rows.csv'\n{REST}"),
            "2 rows and 8 columns; 8 rows are named and the stiffness has 8",
        ),
    ];
    for (text, expected) in cases {
        let error = folder.load(&text).unwrap_err();
        assert!(error.contains(expected) && error.contains("structure.toml"), "{error}\n{expected}");
    }
    // Two rows that say the same leave no displacement for the second slip.
    let twice = folder.load(&table("l.mtx", "twice.mtx").replace("rows = [1]", "rows = [1, 2]")).unwrap();
    let error = twice.structure.assemble().unwrap_err().to_string();
    assert!(error.contains("joint `bolt row 2`") && error.contains("nothing free but slips"), "{error}");
    // A spring to the ground sees the structure move, and says so.
    let ground = table("relative = 'l.mtx'", "relative = 'tip.mtx'\nto_ground = true");
    assert_eq!(folder.load(&ground).unwrap().structure.assemble().unwrap().slips().len(), 1);
}
