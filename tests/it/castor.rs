//! Castor, the scene language of Argence's thesis: what is read of it, and what is refused.

use glam::Vec3;
use pcs_sim::scene::{self, Mesh, ReadOptions, Scene};

use crate::support::command::Folder;

/// The thesis's example, in the words of its chapter 5.
const TABLE: &str = "
/* a table */
#define BROWN 180,90,80,0
top = @a(7,5,0.5) !cu(BROWN);
leg = @a(0.1,0.1,3.5) @t(0,0,-1) !cu(BROWN);  // stands below the floor's height
table = $U(top, leg, @t(7,0,0) leg, @t(7,5,0) leg, @t(0,5,0) leg,);
> table;
";

fn load(folder: &Folder, name: &str, text: &str) -> Result<Scene, String> {
    scene::load(&folder.file(name, text), &ReadOptions::default()).map_err(|error| {
        let text = error.to_string();
        text.rsplit_once(name).map_or(text.clone(), |(_, rest)| rest.to_owned())
    })
}

type Faces = Vec<Vec<[u32; 3]>>;

fn faces(mesh: &Mesh) -> Faces {
    let bits = |point: Vec3| point.to_array().map(f32::to_bits);
    mesh.faces().iter().map(|face| mesh.face_points(face).map(bits).collect()).collect()
}

#[test]
fn the_table_is_its_twin_in_ron_and_the_built_in_one() {
    let folder = Folder::new();
    let read = load(&folder, "table.cas", TABLE).unwrap();
    let volume = read.solids[0].volume;
    assert!((volume - 17.64).abs() < 1e-5, "{volume}");
    let leg = "Place([Translate(0, 0, -1), Scale(0.1, 0.1, 3.5)], Cube())";
    let twin = format!(
        "(meshes: [(shape: Csg(Union([Place([Scale(7, 5, 0.5)], Cube()), {leg},
          Place([Translate(7, 0, 0)], {leg}), Place([Translate(7, 5, 0)], {leg}), Place([Translate(0, 5, 0)], {leg})])))])"
    );
    let twin = load(&folder, "twin.ron", &twin).unwrap();
    assert_eq!(faces(&read.mesh), faces(&twin.mesh));
    let built_in = scene::builtin::generate("table", None, None).unwrap().mesh;
    assert_eq!(faces(&read.mesh), faces(&built_in)[1..], "behind the floor");
    // 180, 90, 80 of a screen.
    let color = read.materials[0].color;
    assert!(color.distance(Vec3::new(0.456, 0.102, 0.080)) < 1e-3, "{color}");
}

#[test]
fn all_that_is_ours_is_read() {
    let folder = Folder::new();
    folder.file("parts.cas", "ball = !sp(255,0,0,0.5);\n");
    let text = "
        #include \"parts.cas\"
        post = @t(0,0,2) @h(0.5) !cy(0,255,0,0);
        roof = @r(0,0,1,45) @s(0,0,1) !co(0,0,255,0);
        wedge = !pr(0,0,2,0,2,2,10,20,30,0);
        glass = \"as(1.5, 0.7, 0.2) -t(1,1,1) ?t2d(4) $D(ball, post);
        flat = @t(5,0,0) $U(!sq(9,9,9,0), @t(2,0,0) !ci(9,9,9,0), @t(4,0,0) !po(0,0,1,0,0,1,9,9,9,0));
        all = $I(@h(4) ball, $U(roof, wedge));
        > glass; > all; > flat;";
    let scene = load(&folder, "all.cas", text).unwrap();
    assert_eq!(scene.solids.len(), 3);
    assert!(scene.solids.iter().all(|solid| solid.closed && solid.volume > 0.0));
    assert!(
        scene.notes.contains(&"2 textures left out: surfaces have one colour here".to_owned()),
        "{:?}",
        scene.notes
    );
    let clear = scene.materials.iter().filter(|material| material.transmittance == 0.7);
    assert!(clear.clone().count() == 2 && clear.clone().all(|it| it.refraction == 1.5 && it.specular == 0.2));
    let sizes = scene::load(&folder.path("all.cas"), &ReadOptions { resolution: 8 }).unwrap();
    assert!(sizes.mesh.faces().len() < scene.mesh.faces().len());
}

#[test]
fn what_cannot_be_is_refused_at_its_place() {
    let folder = Folder::new();
    folder.file("circle.cas", "#include \"circle.cas\"\n");
    let copies: String = (0..20).map(|n| format!("a{} = $U(a{n}, a{n});\n", n + 1)).collect();
    let deep = format!("a = {}!cu(1,1,1,0){};\n> a;", "$U(".repeat(250), ")".repeat(250));
    let chain: String = (0..250).map(|n| format!("c{} = @t(0,0,0.01) c{n};\n", n + 1)).collect();
    let chain = format!("c0 = !cu(1,1,1,0);\n{chain}> c250;");
    let many = format!("a0 = !cu(1,1,1,0);\n{copies}> a20;");
    let mut report = String::new();
    for text in [
        "",
        "a = !cu(1,1,1,0);",
        "a = !cube(1,1,1,0);\n> a;",
        "a = !hp(1,1,1,0);\n> a;",
        "a = !tr(1,1,1,0);\n> a;",
        "a = !ld(land,1,1,1,0,2,2,2,0,3,3,3,0);\n> a;",
        "a = !cu(1,1,1);\n> a;",
        "a = !cu(1,1,300,0);\n> a;",
        "a = !cu(1,1,1,2);\n> a;",
        "a = !pr(0,0,1,0,1,1,1,1,1);\n> a;",
        "a = !pr(0,0,1,1,1,0,0,1,1,1,1,0);\n> a;",
        "leg = !cu(1,1,1,0);\ntable = $U(leg, lag);\n> table;",
        "a = $U(b, b);\nb = $U(a, a);\n> a;",
        "> a;",
        "a = $X(!cu(1,1,1,0));\n> a;",
        "a = @q(1) !cu(1,1,1,0);\n> a;",
        "a = @t(1,2) !cu(1,1,1,0);\n> a;",
        "a = @a(1,0,1) !cu(1,1,1,0);\n> a;",
        "a = @r(0,0,0,90) !cu(1,1,1,0);\n> a;",
        "a = @h(1e20) !cu(1,1,1,0);\n> a;",
        "a = @h(x) !cu(1,1,1,0);\n> a;",
        "a = \"as(0, 1, 0) !cu(1,1,1,0);\n> a;",
        "a = !cu(1,1,1,0)\n> a;",
        "a = ;",
        "a = $D(!cu(1,1,1,0), !cu(1,1,1,0));\n> a;",
        "; a",
        "#include \"../secret.cas\"\n",
        "#include \"/etc/passwd\"\n",
        "#include <stdio.h>\n",
        "#include \"nowhere.cas\"\n",
        "#include \"circle.cas\"\n",
        "#ifdef A\n",
        "#define\n",
        &deep,
        &chain,
        &many,
    ] {
        let answer = load(&folder, "bad.cas", text).map_or_else(|error| error, |scene| scene.notes.join("; "));
        let shown: String = text.chars().take(60).collect();
        report += &format!("{shown}\n    {}\n", answer.replace(&folder.path("").display().to_string(), ""));
    }
    insta::assert_snapshot!(report);
}
