//! How much memory a plant takes of what it asks for.

use switchid::fmu::{DUFFING, plant};
use switchid_fmu_plant::{PlantSlave, functions};
use switchid_fmu_slave::host::{Counting, Instance, Request};
use switchid_fmu_slave::{Interface, Slave, linked_functions};

#[global_allocator]
static COUNTED: Counting = Counting::of_slave(PlantSlave::ROOM);

#[test]
fn an_instance_takes_no_more_than_half_of_what_it_asks_for() {
    let resources = tempfile::tempdir().unwrap();
    for (path, content) in plant(DUFFING).unwrap().files() {
        if let Some(name) = path.strip_prefix("resources/") {
            std::fs::write(resources.path().join(name), content).unwrap();
        }
    }
    let interface = std::fs::read(resources.path().join("interface.json")).unwrap();
    let interface: Interface = serde_json::from_slice(&interface).unwrap();
    let location = resources.path().display().to_string();
    let request = Request { co_simulation: true, guid: &interface.guid, location: Some(&location), logging: false };
    let (instance, made) = COUNTED.most(|| Instance::new(linked_functions!(functions), &request).unwrap());
    let (status, begun) = COUNTED.most(|| instance.initialize(0.0));
    assert_eq!(status, 0);
    let most = made.max(begun);
    assert!(2 * most <= PlantSlave::ROOM && 4 * most >= PlantSlave::ROOM, "{most} bytes");
}
