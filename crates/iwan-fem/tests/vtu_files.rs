//! VTU files hold mesh and fields with all their bits.

use iwan_fem::mesh::beam::{Configuration, beam};
use iwan_fem::mesh::vtu::{Field, grid, series};

/// Attributes of the array called `name`, and its bytes.
fn array<'a>(file: &'a [u8], name: &str) -> (String, &'a [u8]) {
    let mark = b"<AppendedData encoding=\"raw\">\n_";
    let start = file.windows(mark.len()).position(|w| w == mark).expect("appended data") + mark.len();
    let head = std::str::from_utf8(&file[..start]).expect("the head is text");
    let element = head.lines().find(|line| line.contains(&format!("Name=\"{name}\""))).expect(name);
    let offset =
        element.split("offset=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("an offset");
    let at = start + offset.parse::<usize>().expect("a number");
    let length = u64::from_le_bytes(file[at..at + 8].try_into().expect("eight bytes"));
    (element.into(), &file[at + 8..at + 8 + usize::try_from(length).expect("a length")])
}

fn floats(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().expect("eight bytes"))).collect()
}

fn integers(bytes: &[u8]) -> Vec<usize> {
    let value = |b: &[u8]| i64::from_le_bytes(b.try_into().expect("eight bytes"));
    bytes.chunks_exact(8).map(|b| usize::try_from(value(b)).expect("not negative")).collect()
}

#[test]
fn a_grid_holds_the_mesh_and_its_fields() {
    let mesh = beam(Configuration::A, 1);
    let shape: Vec<f64> = mesh.positions.iter().flat_map(|p| [0.0, 0.1 * p[0], p[0] * p[0]]).collect();
    let size: Vec<f64> = mesh.positions.iter().map(|p| p[0].abs()).collect();
    let fields =
        [Field { name: "mode 1 <\"a\" & b>", values: &shape }, Field { name: "size", values: &size }];
    let file = grid(&mesh, &fields);
    assert!(file.ends_with(b"\n</AppendedData>\n</VTKFile>\n"));
    let (element, bytes) = array(&file, "mode 1 &lt;&quot;a&quot; &amp; b&gt;");
    assert!(
        element.contains("type=\"Float64\"") && element.contains("NumberOfComponents=\"3\""),
        "{element}"
    );
    assert_eq!(floats(bytes), shape);
    let (element, bytes) = array(&file, "size");
    assert!(element.contains("NumberOfComponents=\"1\""));
    assert_eq!(floats(bytes), size);
    assert_eq!(floats(array(&file, "Points").1), mesh.positions.as_flattened());
    let nodes: Vec<usize> = mesh.elements.iter().flat_map(|e| e.nodes.clone()).collect();
    assert_eq!(integers(array(&file, "connectivity").1), nodes);
    assert_eq!(integers(array(&file, "offsets").1), (1..=662).map(|n| 8 * n).collect::<Vec<_>>());
    assert_eq!(array(&file, "types").1, [12; 662]);
    assert_eq!(integers(array(&file, "node").1).len(), 1554);
}

#[test]
fn a_series_names_its_files_in_time() {
    let text = series([(0.0, "a/0.vtu"), (1e-5, "a/1.vtu")].into_iter());
    assert!(text.contains("<DataSet timestep=\"0.00001\" part=\"0\" file=\"a/1.vtu\"/>"), "{text}");
    assert_eq!(text.matches("<DataSet").count(), 2);
}

#[test]
#[should_panic(expected = "field short has a value or vector for each node")]
fn a_field_of_another_length_is_a_mistake() {
    let _ = grid(&beam(Configuration::A, 1), &[Field { name: "short", values: &[1.0] }]);
}
