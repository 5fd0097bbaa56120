use fmi_adapter::fmi3::Status;

use crate::harness::{Importer, Resources};
use crate::integrator::{DIVERGE, PANIC, PANIC_ON_CREATE, TROUBLE, X_1};

#[test]
fn a_panic_fails_the_instance_and_reset_recovers_it() {
    let resources = Resources::new();
    let importer = Importer::stepping(&resources);
    importer.set(TROUBLE, PANIC);
    importer.refused(importer.step(0.0, 0.01).0, "step was told to panic");
    importer.refused(importer.step(0.0, 0.01).0, "not allowed in state Failed");
    importer.refused(importer.try_get(&[X_1], &mut [0.0]), "not allowed in state Failed");

    assert_eq!(unsafe { crate::fmi3Reset(importer.instance) }, Status::Ok);
    importer.start();
    assert_eq!(importer.step(0.0, 0.01).0, Status::Ok);
}

#[test]
fn a_failed_step_too_and_a_stored_state_recovers_it() {
    let resources = Resources::new();
    for trouble in [PANIC, DIVERGE] {
        let importer = Importer::stepping(&resources);
        importer.step(0.0, 0.01);
        let (state, before) = (importer.get_state(), importer.get([0, X_1]));
        importer.set(TROUBLE, trouble);
        importer.refused(importer.step(0.01, 0.01).0, "fmi3DoStep: ");
        importer.refused(importer.step(0.01, 0.01).0, "not allowed in state Failed");
        assert_eq!(importer.set_state(state), Status::Ok);
        assert_eq!(importer.get([0, X_1]), before);
        assert_eq!(importer.step(0.01, 0.01).0, Status::Ok);
    }
}

#[test]
fn a_panic_while_creating() {
    let resources = Resources::new();
    resources.write("landing", PANIC_ON_CREATE);
    let importer = Importer::new(&resources);
    importer.refused(importer.enter(), "create was told to panic");
    assert_eq!(unsafe { crate::fmi3Reset(importer.instance) }, Status::Ok);
    resources.write("landing", "2");
    importer.start();
}
