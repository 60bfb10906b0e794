//! Any text as a scenario: an error, or a scenario that is the same once it is written and read again.
#![no_main]

use iwan_input::InputText;
use iwan_input::scenario::{Force, Overrides, Scenario, SteadyScenario, to_toml};
use libfuzzer_sys::fuzz_target;

fn read(text: &str) -> Result<Scenario, iwan_input::InputError> {
    Scenario::read(&InputText::built_in("fuzz.toml", text), &Overrides::default())
}

fuzz_target!(|text: &str| {
    // No file of this machine is opened.
    if text.contains('/') {
        return;
    }
    let _ = SteadyScenario::read(&InputText::built_in("fuzz.toml", text));
    let Ok(scenario) = read(text) else { return };
    if matches!(scenario.force, Force::Formula(..)) && scenario.structure.is_none() {
        let written = to_toml(&scenario, "force.csv");
        match read(&written) {
            Ok(again) => assert_eq!(again, scenario, "{written}"),
            Err(error) => panic!("{error}\n{written}"),
        }
    }
});
