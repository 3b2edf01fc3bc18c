//! The text of dumps, letter by letter.

use std::fs::read_to_string;

use crate::formats::moments::{after, start, write};

const GRAINS: &str = "\
ITEM: UNITS
si
ITEM: PARAMETERS
program: slump; bond: 20 <&> 30
id: number of the disc; fixed discs follow the grains; type: grain, fixed disc, or a grain that went through a \
wall or left the world (1 grain, 2 fixed, 3 lost); x [m]: centre; y [m]: centre; radius [m]: radius; vx [m/s]: \
velocity of the centre; vy [m/s]: velocity of the centre; omegaz [rad/s]: angular velocity, anticlockwise; \
coordination_number [1]: …
ITEM: TIME
0.0
ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
4
ITEM: BOX BOUNDS ss ss ss
-0.75 1.3333333333333333
-1.75 0.75
-0.75 0.75
ITEM: ATOMS id type element x y radius vx vy omegaz coordination_number angle mass …
0 1 grain 0.0 0.25 0.5 0.3333333333333333 -2e-9 1e22 2.0 -0.0 0.125 …
1 1 grain 1.0 0.25 0.3333333333333333 0.3333333333333333 -2e-9 1e22 2.0 -0.0 0.125 …
2 3 lost -1000000.0 0.0 0.5 0.3333333333333333 -2e-9 1e22 0.0 -0.0 0.125 …
3 2 fixed 0.0 -1.0 0.75 0.0 0.0 0.0 NaN 0.0 NaN …
";
const SECOND_HEAD: &str = "ITEM: TIME\n1.0\nITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n4\n";

const CONTACTS: &str = "\
ITEM: TIME
0.0
ITEM: TIMESTEP
0
ITEM: NUMBER OF BONDS
2
ITEM: BOX BOUNDS ss ss ss
-0.75 1.3333333333333333
-1.75 0.75
-0.75 0.75
ITEM: BONDS batom1 batom2 kind_j x y nx ny gap normal_force tangential_force status bond stretch age
0 1 0 0.5 0.25 -1.0 -0.0 -5e-324 0.3333333333333333 -1.5 2 -1 NaN 0
0 3 1 0.5 0.25 0.0 1.0 -5e-324 0.3333333333333333 -1.5 2 -1 NaN 0
";

#[test]
fn dumps_say_this() {
    let folder = tempfile::tempdir().expect("a folder");
    write(&mut start(folder.path()), 0..2);
    let read = |name: &str| read_to_string(folder.path().join("ovito").join(name)).expect(name);
    let grains = read("grains.dump");
    let rest = after(&grains, GRAINS);
    assert!(rest.starts_with(SECOND_HEAD), "{rest}");
    assert_eq!(rest.lines().count(), 15);
    let contacts = read("contacts.dump");
    let words =
        "status: what the laws of contact and friction make of it (0 open, 1 stick, 2 slip)";
    assert!(contacts.contains(&format!("; {words}; ")), "{contacts}");
    after(
        &contacts,
        &format!("ITEM: UNITS\nsi\nITEM: PARAMETERS\nprogram: slump; …\n…\n{CONTACTS}"),
    );
}
