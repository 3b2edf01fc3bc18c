//! Tests of the paths of files that a study (a list of runs) names, and of temporary files that killed programs leave.

use super::{runs, study, sweep};
use crate::program::*;

#[test]
fn files_that_a_study_names_are_beside_it_and_it_is_the_same_from_everywhere() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for inner in ["study", "study/scenes", "elsewhere"] {
        std::fs::create_dir(at(inner)).expect("a folder");
    }
    let scene = run(&mut slump("scene --scene collision")).stdout;
    write(at("study/scenes/my scene.toml"), scene);
    write(at("study/discs.csv"), "x,y,radius\n0,0.0075,0.0025\n");
    let fingerprint = |out: &str| json(at(out).join("study.json"))["fingerprint"].clone();
    for (name, base) in
        [("scene", "scene = \"scenes/my scene.toml\""), ("discs", "initial = \"discs.csv\"")]
    {
        let text =
            format!("name = \"own\"\n[base]\n{base}\nduration = 0.02\n[vary]\nbond = [0, 1]\n");
        write(at("study/own.toml"), text);
        let found =
            [("study", "own.toml"), ("elsewhere", "../study/own.toml")].map(|(from, study)| {
                let out = format!("{name} from {from}");
                let mut command = slump("sweep");
                command.current_dir(at(from)).arg(study).arg("--out").arg(at(&out));
                succeed(&mut command);
                (fingerprint(&out), runs(&at(&out)))
            });
        assert_eq!(found[0], found[1], "{name}");
    }
}

#[test]
fn what_a_kill_left_of_files_goes_once_a_study_is_complete() {
    let folder = folder();
    let text = "name = 'tiny'\n[base]\nscene = 'collision'\nduration = 0.01\n[series]\ninterval = 0.005\n[vary]\nbond = [0, 1]\n";
    let (study, out) = (study(folder.path(), text), folder.path().join("out"));
    succeed(&mut sweep(&study, &out, &["--shard", "1/2"]));
    let first = names_in(&out.join("series"))[0].clone();
    let left =
        [out.join(format!("series/.{first}.Ab12Cd.part")), out.join(".runs.csv.Ef34Gh.part")];
    left.iter().for_each(|path| write(path, "half"));
    // A file whose name is not one that Slump gives to temporary files.
    let other = out.join("series/.notes.part");
    write(&other, "mine");
    succeed(&mut sweep(&study, &out, &[]));
    assert!(left.iter().all(|path| !path.exists()));
    assert_eq!((names_in(&out.join("series")).len(), read(&other).as_str()), (3, "mine"));
}

#[test]
fn every_shipped_study_can_be_run() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/studies");
    let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let studies: Vec<PathBuf> =
        files.filter(|path| path.extension().is_some_and(|it| it == "toml")).collect();
    assert!(studies.len() > 20, "{studies:?}");
    for study in studies {
        succeed(slump("sweep").arg("count").arg(study));
    }
}
