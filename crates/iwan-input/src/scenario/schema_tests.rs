//! The shipped JSON Schema and the reader agree: they know the same keys, and accept and refuse the same files.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use super::read::KEYS;
use super::{
    Overrides, SCHEMA, Scenario, SteadyScenario, built_in, curves, force, joint, method, mode, part,
    structure, sweep, to_toml,
};
use crate::schema::{Schema, as_json};
use crate::section::{TableKind, known};
use crate::text::InputText;

fn schema() -> Schema {
    Schema::new(SCHEMA)
}

#[test]
fn plain_tables_have_the_same_keys() {
    schema().has("/properties", KEYS);
    schema().has("/$defs/mode/properties", mode::KEYS);
    schema().has("/$defs/shared_joint/properties", joint::KEYS);
    schema().has("/$defs/initial/properties", mode::INITIAL_KEYS);
    schema().has("/$defs/time/properties", method::TIME_KEYS);
    schema().has("/$defs/structure/properties", structure::KEYS);
    schema().has("/$defs/curves/anyOf/1/properties", curves::KEYS);
    schema().has("/$defs/sweep/properties", sweep::KEYS);
}

#[test]
fn every_kind_has_the_same_keys() {
    let tables: [(&str, &str, &'static [TableKind]); 4] = [
        ("joint", "kind", crate::LAWS),
        ("part", "law", part::KINDS),
        ("force", "kind", force::KINDS),
        ("method", "kind", method::KINDS),
    ];
    for (table, tells, kinds) in tables {
        schema().has_kinds(table, tells, kinds);
        assert_eq!(known(kinds)[0], "kind");
    }
}

fn read(text: &str) -> Result<Scenario, crate::InputError> {
    Scenario::read(&InputText::built_in("test.toml", text), &Overrides::default())
}

const GOOD: &str = "\
[[mode]]
name = 'a'
frequency = 100
joint = { k_t = 1e4, f_s = 10.0, chi = -0.5, beta = 0.1 }
initial = { displacement = 1e-4 }
[force]
kind = 'none'
[time]
step = 1e-4
duration = 0.1
";

#[test]
fn shipped_scenarios_are_valid_and_written_ones_too() {
    let validator = schema().validator();
    let texts = built_in().iter().map(|b| b.text).chain([GOOD]);
    for text in texts {
        assert!(validator.is_valid(&as_json(text)));
        let scenario = read(text).unwrap();
        let written = to_toml(&scenario, "force.csv");
        assert!(validator.is_valid(&as_json(&written)), "{written}");
        assert_eq!(read(&written).unwrap(), scenario);
    }
}

#[test]
fn every_variant_is_valid_and_survives_writing() {
    let validator = schema().validator();
    let joint = "joint = { k_t = 1e4, f_s = 10.0, chi = -0.5, beta = 0.1 }";
    let none = "kind = 'none'";
    let variants = [
        (joint, "joint = { kind = 'jenkins', k_t = 1e4, f_s = 10.0 }"),
        (joint, "joint = { k_t = 1e4, f_s = 10.0, chi = -0.5, beta = 0.1, theta = 0.8 }"),
        (
            joint,
            "joint = { kind = 'five-parameter', k_t = 1e4, f_s = 10.0, chi = -0.5, beta = 0.1, theta = 1 }",
        ),
        (joint, "joint = { kind = 'uniform', k_t = 1e4, f_s = 10.0, width = 0.5 }"),
        (joint, "joint = { kind = 'tabulated', strength = [0.0, 1e-3], density = [1e7, 1e6], dirac = 10.0 }"),
        (joint, "joint = { k_t = 1e6, f_s = 10.0, chi = 0, beta = 0 }\nallow_negative_residual = true"),
        ("initial", "informed = [1e-6, 1e-3]\ninitial"),
        (joint, "parts = [{ law = 'power-damping', c = 0.3, n = 1.5 }, { law = 'coulomb', force = 2 }]"),
        (
            joint,
            "parts = [{ law = 'spring', k = -1e9, exponent = 3 }, { law = 'pinning', k = 10, gap = 1e-3 }]",
        ),
        (joint, "outputs = { tip = 1, \"left end\" = -2.5 }\ndamping_ratio = 0.01"),
        (none, "kind = 'haversine'\namplitude = 1\nduration = 1e-3"),
        (none, "kind = 'half-sine'\namplitude = -1.5\nduration = 1e-3"),
        (none, "kind = 'step'\namplitude = 1"),
        (none, "kind = 'step'\namplitude = 1\nduration = 0.01"),
        (none, "kind = 'sine'\namplitude = 1\nfrequency = 90\n"),
        ("[time]", "[method]\nkind = 'half-cycle'\n[time]"),
        ("[time]", "[method]\nkind = 'averaging'\n[time]"),
        ("[time]", "[method]\nkind = 'event'\nsliders = 10\ngrid = 'uniform'\n[time]"),
        ("[time]", "[method]\njoint = 'continuum'\n[time]"),
        ("[time]", "[method]\nbeta = 0.3\ngamma = 0.6\n[time]"),
        ("[time]", "[method]\nprewarp = false\nsliders = 50\ngrid = 'uniform'\n[time]"),
    ];
    let law = &GOOD[GOOD.find("frequency").unwrap()..GOOD.find("initial").unwrap()];
    let curves = [
        "curves = { amplitude = [1e-6, 1e-3], frequency = [100, 99], damping_ratio = [1e-3, 0.02] }\n",
        "curves = { amplitude = [1e-6, 1e-3], frequency = [100, 99], damping_ratio = [0, 0.02], extrapolate = true }\n",
    ];
    for (from, to) in variants.into_iter().chain(curves.map(|curves| (law, curves))) {
        let text = GOOD.replace(from, to);
        assert!(validator.is_valid(&as_json(&text)), "{text}");
        let scenario = read(&text).unwrap();
        assert_eq!(read(&to_toml(&scenario, "x")).unwrap(), scenario, "{text}");
    }
}

const ON_STRUCTURE: &str = "\
[structure]
name = 'paper-a'
[force]
kind = 'haversine'
amplitude = 10
duration = 1.6e-3
[time]
step = 1e-5
duration = 0.01
";

#[test]
fn structures_are_valid_and_survive_writing() {
    let validator = schema().validator();
    let variants = [
        "name = 'paper-a'",
        "name = 'paper-b'\nmodel = 'full'",
        "name = 'paper-a'\nbasis = 50\nframes = 10",
        "path = 'beam.toml'\ntolerance = 1e-3\nmodes = ['bending 1', 'torsion 1']",
        "name = 'paper-a'\n[method]\njoint = 'continuum'",
        "name = 'paper-a'\n[method]\nprewarp = false\nsliders = 20\ngrid = 'uniform'",
    ];
    for variant in variants {
        let text = ON_STRUCTURE.replace("name = 'paper-a'", variant);
        assert!(validator.is_valid(&as_json(&text)), "{text}");
        let scenario = read(&text).unwrap();
        let written = to_toml(&scenario, "x");
        assert!(validator.is_valid(&as_json(&written)), "{written}");
        assert_eq!(
            read(&written).unwrap(),
            Scenario { structure: read(&written).unwrap().structure, ..scenario }
        );
    }
    let bad = [
        "name = 'paper-c'",
        "model = 'full'",
        "name = 'paper-a'\npath = 'beam.toml'",
        "name = 'paper-a'\nbasis = 0",
        "name = 'paper-a'\ntolerance = 0",
        "name = 'paper-a'\nmodel = 'quick'",
        "name = 'paper-a'\n[[mode]]\nname = 'a'\nfrequency = 1",
    ];
    for variant in bad {
        let text = ON_STRUCTURE.replace("name = 'paper-a'", variant);
        assert!(!validator.is_valid(&as_json(&text)), "{text}");
        assert!(read(&text).is_err(), "{text}");
    }
    for refused in ["model = 'full'\nbasis = 3", "model = 'full'\nframes = 3", "basis = 3\ntolerance = 1e-3"]
    {
        assert!(read(&ON_STRUCTURE.replace("[force]", &format!("{refused}\n[force]"))).is_err());
    }
    for method in ["prewarp = true", "kind = 'half-cycle'", "beta = 0.3\ngamma = 0.6"] {
        let error = read(&format!("{ON_STRUCTURE}[method]\n{method}\n")).unwrap_err().to_string();
        assert!(error.contains("does not apply to a structure"), "{error}");
    }
}

#[test]
fn what_the_schema_refuses_the_reader_refuses() {
    let validator = schema().validator();
    let bad = [
        ("frequency = 100", "frequency = -100"),
        ("frequency = 100", "frequncy = 100"),
        ("frequency = 100", "frequency = 'fast'"),
        ("name = 'a'", "name = ''"),
        ("chi = -0.5", "chi = -1.0"),
        ("beta = 0.1", "beta = 0.1, gamma = 1"),
        ("beta = 0.1", "beta = 0.1, theta = 0"),
        ("beta = 0.1", "beta = 0.1, theta = 1.5"),
        ("beta = 0.1", "beta = 0.1, theta = 0.8, kind = 'four-parameter'"),
        ("beta = 0.1", "beta = 0.1, kind = 'five-parameter'"),
        ("beta = 0.1", "beta = 0.1, kind = 'none'"),
        ("kind = 'none'", "kind = 'none'\namplitude = 1"),
        ("kind = 'none'", "kind = 'haversine'\namplitude = 1"),
        ("step = 1e-4", "step = 0"),
        ("[time]", "[method]\nkind = 'half-cycle'\nsliders = 10\n[time]"),
        ("[time]", "[method]\nsliders = 0\n[time]"),
        ("[time]", "[extra]\n[time]"),
        ("initial", "parts = [{ law = 'glue' }]\ninitial"),
        ("initial", "informed = [1e-6]\ninitial"),
        ("initial", "informed = [0, 1e-3]\ninitial"),
        ("initial", "parts = [{ c = 1, n = 1 }]\ninitial"),
        ("initial", "parts = [{ law = 'spring', k = 1, exponent = 1 }]\ninitial"),
        ("initial", "parts = [{ law = 'coulomb', force = 1, gap = 1 }]\ninitial"),
        ("initial", "parts = [{ law = 'pinning', k = 1, gap = 0 }]\ninitial"),
        ("initial", "curves = { amplitude = [1, 2], frequency = [1, 1], damping_ratio = [0, 0] }\ninitial"),
        (
            "frequency = 100\n",
            "curves = { amplitude = [1, 2], frequency = [1, 1], damping_ratio = [0, 0] }\n",
        ),
        ("frequency = 100\n", ""),
    ];
    for (from, to) in bad {
        let text = GOOD.replace(from, to);
        assert!(!validator.is_valid(&as_json(&text)), "{text}");
        assert!(read(&text).is_err(), "{text}");
    }
}

const SHARED: &str = "\
[[mode]]
name = 'a'
frequency = 100
[[mode]]
name = 'b'
frequency = 500
joint = { kind = 'jenkins', k_t = 1e4, f_s = 10.0 }
[[joint]]
name = 'left'
law = { k_t = 1e5, f_s = 10.0, chi = -0.5, beta = 0.1 }
participation = { a = 1, b = -2.5 }
compliance = 1e-6
[[joint]]
law = { kind = 'jenkins', k_t = 1e5, f_s = 10.0 }
participation = { b = 0.5 }
[force]
kind = 'none'
[time]
step = 1e-5
duration = 0.1
";

/// Joints that modes share are accepted by schema and reader, keep their values when written and read again, and are refused with place and
/// remedy when faulty.
#[test]
fn shared_joints_are_read_written_and_refused() {
    let validator = schema().validator();
    let compliance = "compliance = 1e-6";
    for (from, to) in [
        ("", ""),
        (compliance, ""),
        (compliance, "compliance = { left = 1e-6 }\nslip_at_force = 1e-9"),
        ("[force]", "compliance = { 'joint 2' = 1e-6, left = -3e-7 }\n[force]"),
        ("[time]", "[method]\njoint = 'continuum'\nprewarp = false\n[time]"),
    ] {
        let text = SHARED.replacen(from, to, 1);
        assert!(validator.is_valid(&as_json(&text)), "{text}");
        let scenario = read(&text).unwrap();
        assert_eq!(scenario.joints[1].joint.name, "joint 2");
        assert_eq!(scenario.joints[0].joint.compliance[1], scenario.joints[1].joint.compliance[0]);
        assert_eq!(read(&to_toml(&scenario, "x")).unwrap(), scenario, "{text}");
    }
    let invalid = [
        ("participation = { b = 0.5 }\n", ""),
        ("participation = { b = 0.5 }", "participation = {}"),
        ("law = { kind = 'jenkins', k_t = 1e5, f_s = 10.0 }\n", ""),
        (compliance, "compliance = -1e-6"),
        (compliance, "complience = 1e-6"),
        ("name = 'left'", "name = ''"),
    ];
    for (from, to) in invalid {
        let text = SHARED.replacen(from, to, 1);
        assert!(!validator.is_valid(&as_json(&text)), "{text}");
        assert!(read(&text).is_err(), "{text}");
    }
    let said = |from: &str, to: &str| read(&SHARED.replacen(from, to, 1)).unwrap_err().to_string();
    let wrong = [
        ("b = -2.5", "bb = -2.5", "did you mean \"b\"?"),
        ("a = 1,", "a = nan,", "a = NaN is out of range"),
        ("{ b = 0.5 }", "{ b = 0 }", "no mode that moves the joint"),
        ("name = 'left'", "name = 'b'", "name of a mode, a point or another joint"),
        (compliance, "compliance = 2e-5", "must be below 1"),
        (compliance, "compliance = { rigth = 1 }", "there is no joint \"rigth\""),
        (compliance, "compliance = { left = 1e-6, 'joint 2' = 5e-6 }", "positive semi-definite"),
        ("b = -2.5", "b = -25", "nothing holds the modes"),
        ("[time]", "[method]\nkind = 'half-cycle'\n[time]", "need newmark"),
        ("frequency = 100", "frequency = 100\nparts = [{ law = 'coulomb', force = 2 }]", "leave out parts"),
    ];
    for (from, to, expected) in wrong {
        let message = said(from, to);
        assert!(message.contains(expected) && message.contains("test.toml"), "{message}");
    }
    assert!(said(compliance, "compliance = 2e-5").contains("joint \"left\""));
    // Steady vibration reads the same modes and joints.
    let steady = SteadyScenario::read(&InputText::built_in("test.toml", SHARED)).unwrap();
    assert_eq!((steady.modes.len(), steady.joints.len()), (2, 2));
}

/// Curves are read from a file as from the scenario itself, and errors in them name their place.
#[test]
fn curves_come_from_a_file_too() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("curves.csv"),
        "amplitude,frequency,damping_ratio\n1e-6,100,0.001\n1e-3,99,0.02\n",
    )
    .unwrap();
    std::fs::write(folder.path().join("two.csv"), "a,b\n1,2\n2,3\n").unwrap();
    let law = &GOOD[GOOD.find("frequency").unwrap()..GOOD.find("initial").unwrap()];
    let at = |curves: &str| {
        let mut source = InputText::built_in("test.toml", &GOOD.replace(law, curves));
        source.folder = folder.path().to_path_buf();
        Scenario::read(&source, &Overrides::default())
    };
    let here =
        at("curves = { amplitude = [1e-6, 1e-3], frequency = [100, 99], damping_ratio = [0.001, 0.02] }\n");
    assert_eq!(at("curves = 'curves.csv'\n").unwrap(), here.unwrap());
    let mode = at("curves = { path = 'curves.csv', extrapolate = true }\n").unwrap().modes.remove(0).mode;
    assert!(mode.curves.unwrap().extrapolates() && mode.frequency == 100.0);
    let said = |curves: &str| at(curves).unwrap_err().to_string();
    assert!(said("curves = 'none.csv'\n").contains("test.toml:3"), "{}", said("curves = 'none.csv'\n"));
    assert!(said("curves = 'two.csv'\n").contains("2 columns, not 3"));
    let falling = "curves = { amplitude = [1e-3, 1e-6], frequency = [100, 99], damping_ratio = [0, 0] }\n";
    assert!(said(falling).contains("amplitude[1]"), "{}", said(falling));
    assert!(said(&format!("frequency = 100\n{falling}")).contains("exclude each other"));
}

/// The error for a part out of range names its number, key and place.
#[test]
fn a_wrong_part_is_named() {
    let said =
        |parts: &str| read(&GOOD.replace("initial", &format!("{parts}\ninitial"))).unwrap_err().to_string();
    let spring = said("parts = [{ law = 'coulomb', force = 1 }, { law = 'spring', k = 1, exponent = 0.5 }]");
    assert!(spring.contains("test.toml:5") && spring.contains("part 2 of mode \"a\""), "{spring}");
    assert!(spring.contains("exponent = 0.5 is out of range: must satisfy 1 < exponent"), "{spring}");
    assert!(
        said("parts = [{ law = 'sprig', k = 1, exponent = 3 }]")
            .contains("power-damping, coulomb, spring, pinning")
    );
    assert!(said("parts = [{ law = 'coulomb', forse = 1 }]").contains("did you mean `force`?"));
    assert!(said("parts = 3").contains("parts is an integer"));
}

const SWEEP: &str = "\
[[mode]]
name = 'a'
frequency = 100
[sweep]
from = 90
to = 110
force = [1, 2.5]
";

#[test]
fn sweeps_need_neither_force_nor_time() {
    let validator = schema().validator();
    let steady = |text: &str| SteadyScenario::read(&InputText::built_in("test.toml", text));
    for held in ["force", "base_acceleration", "displacement", "velocity", "acceleration"] {
        let text = SWEEP.replace("force", held) + "at = 'tip'\nharmonics = 7\npoints = 50\n";
        assert!(validator.is_valid(&as_json(&text)), "{text}");
        let table = steady(&text).unwrap().sweep.unwrap();
        assert_eq!((table.sweep.control.name(), table.sweep.harmonics), (held, 7));
        assert!(read(&text).unwrap_err().to_string().contains("[time] is missing"), "{text}");
    }
    let bad = [
        ("from = 90", "from = 0"),
        ("from = 90", "from = -1"),
        ("force = [1, 2.5]", "force = [1, 0]"),
        ("force = [1, 2.5]", "force = []"),
        ("force = [1, 2.5]", ""),
        ("force = [1, 2.5]", "force = [1]\nvelocity = [1]"),
        ("force = [1, 2.5]", "force = [1]\nharmonics = 2"),
        ("force = [1, 2.5]", "force = [1]\nharmonics = 33"),
        ("force = [1, 2.5]", "force = [1]\npoints = 3"),
        ("force = [1, 2.5]", "forces = [1]"),
    ];
    for (from, to) in bad {
        let text = SWEEP.replace(from, to);
        assert!(!validator.is_valid(&as_json(&text)), "{text}");
        assert!(steady(&text).is_err(), "{text}");
    }
    // Errors that the schema cannot express.
    let error = steady(&SWEEP.replace("to = 110", "to = 80")).unwrap_err().to_string();
    assert!(error.contains("to = 80 is out of range"), "{error}");
}
