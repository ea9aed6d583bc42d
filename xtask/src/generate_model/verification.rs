//! The structures against closed forms: masses, rigid bodies, beams.

use std::f64::consts::{PI, TAU};

use faer::Mat;

use super::blade::{Blade, Cells};
use super::material::STEEL;
use super::mesh::Mesh;
use super::plan::{Generated, Places, choose_sites};
use super::sector::Sectors;
use super::structure::Structure;
use super::{lumped, resonances};

const STRAIGHT: Blade =
    Blade { length: 0.2, chord: 0.011, thickness: 0.006, taper: 1.0, twist: 0.0, edge: 1.0 };
const TWISTED: Blade =
    Blade { length: 0.2, chord: 0.045, thickness: 0.006, taper: 0.7, twist: 0.5, edge: 0.4 };
const SECTORS: Sectors = Sectors { blade: TWISTED, count: 24, ring: false, engine_order: 3 };

fn free(mesh: &Mesh) -> Structure {
    let mut mesh = mesh.clone();
    mesh.clamped.fill(false);
    mesh.assemble(&STEEL).unwrap().0
}

fn energy(a: &[f64], b: Vec<f64>) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Three translations and three rotations about the origin, in the directions of the mesh.
fn rigid_bodies(mesh: &Mesh) -> Vec<Vec<f64>> {
    let motion = |number: usize, node: &[f64; 3]| {
        let mut moved = [0.0; 3];
        let axis = number % 3;
        if number < 3 {
            moved[axis] = 1.0;
        } else {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            (moved[b], moved[c]) = (-node[c], node[b]);
        }
        let frame = mesh.directions.frame(node);
        frame.map(|unit| unit.iter().zip(moved).map(|(e, u)| e * u).sum::<f64>())
    };
    (0..6).map(|number| mesh.nodes.iter().flat_map(|node| motion(number, node)).collect()).collect()
}

fn meshes() -> [(Mesh, &'static str); 3] {
    let cells = Cells { chord: 4, thickness: 2, span: 10 };
    let ring = Sectors { ring: true, count: 8, ..SECTORS };
    [
        (TWISTED.mesh(&cells), "blade"),
        (SECTORS.bare_mesh(600).unwrap(), "sector"),
        (ring.bare_mesh(1300).unwrap(), "ring"),
    ]
}

#[test]
fn rigid_bodies_have_mass_and_no_strain() {
    for (mesh, name) in meshes() {
        let structure = free(&mesh);
        let largest = structure.stiffness.entries.iter().fold(0.0_f64, |most, entry| most.max(entry.2));
        let bodies = rigid_bodies(&mesh);
        let masses: Vec<f64> = bodies.iter().map(|x| energy(x, structure.mass.times(x))).collect();
        for (number, x) in bodies.iter().enumerate() {
            let size = energy(x, x.clone());
            let strain = energy(x, structure.stiffness.times(x)).abs();
            assert!(strain < 1e-13 * largest * size, "{name}, body {number}: {strain:e}");
        }
        assert!((masses[0] - masses[2]).abs() < 1e-12 * masses[0], "{name}: {masses:?}");
        // A strain does have energy: x stretched by one, and the same body has no other rigid motion.
        let stretched: Vec<f64> = mesh
            .nodes
            .iter()
            .flat_map(|node| mesh.directions.frame(node).map(|unit| unit[0] * node[0]))
            .collect();
        let strain = energy(&stretched, structure.stiffness.times(&stretched));
        // A uniform strain ε_x = 1 with ε_y = ε_z = 0 has the energy (λ + 2 μ) V: the patch test.
        let volume = masses[0] / STEEL.density;
        let expected = (STEEL.lame() + 2.0 * STEEL.shear()) * volume;
        assert!((strain / expected - 1.0).abs() < 1e-10, "{name}: {strain} for {expected}");
    }
}

#[test]
fn mass_is_volume_times_density() {
    let blade = Blade { taper: 0.6, ..STRAIGHT };
    let mesh = blade.mesh(&Cells { chord: 3, thickness: 2, span: 5 });
    let structure = free(&mesh);
    let mass = |direction: usize| {
        let x: Vec<f64> = (0..structure.dofs()).map(|dof| f64::from(dof % 3 == direction)).collect();
        energy(&x, structure.mass.times(&x))
    };
    // Chord and thickness taper linearly: ∫ (1 − 0.4 s)² ds = 1 − 0.4 + 0.16/3.
    let volume = 0.2 * 0.011 * 0.006 * (1.0 - 0.4 + 0.16 / 3.0);
    for direction in 0..3 {
        assert!((mass(direction) / (STEEL.density * volume) - 1.0).abs() < 1e-12, "{}", mass(direction));
    }
}

fn lowest(structure: &Structure, count: usize) -> Vec<f64> {
    // Any start that no mode is orthogonal to; the golden ratio repeats nothing.
    let start =
        |i: usize, j: usize| ((i + 1) as f64 * (j + 1) as f64 * 0.618_033_988_749_894_9).fract() - 0.5;
    resonances::lowest(structure, &[], 0.0, Mat::from_fn(structure.dofs(), 8, start), count).unwrap()
}

/// Roots of cosh λ cos λ = −1.
const CANTILEVER: [f64; 2] = [1.875_104_068_711_961, 4.694_091_132_974_175];

/// f = λ²/(2π L²) √(E h²/(12 ρ)) for a beam of depth h.
fn euler_bernoulli(lambda: f64, depth: f64) -> f64 {
    let wave = (STEEL.young * depth * depth / (12.0 * STEEL.density)).sqrt();
    lambda * lambda / (TAU * STRAIGHT.length * STRAIGHT.length) * wave
}

#[test]
fn a_slender_blade_bends_as_a_beam() {
    // One element across: without the incompatible modes this is 40 % too stiff and more.
    let cells = Cells { chord: 1, thickness: 1, span: 40 };
    let Generated { structure, .. } = STRAIGHT.generate(&cells).unwrap();
    let found = lowest(&structure, 3);
    let known = [
        euler_bernoulli(CANTILEVER[0], STRAIGHT.thickness),
        euler_bernoulli(CANTILEVER[0], STRAIGHT.chord),
        euler_bernoulli(CANTILEVER[1], STRAIGHT.thickness),
    ];
    for (found, known) in found.iter().zip(known) {
        assert!((found / known - 1.0).abs() < 0.02, "{found} Hz, the beam has {known} Hz");
    }
}

#[test]
fn twist_and_taper_raise_the_first_frequency_as_they_should() {
    let cells = Cells { chord: 2, thickness: 1, span: 24 };
    let first = |blade: Blade| {
        let generated = blade.generate(&cells).unwrap();
        lowest(&generated.structure, 1)[0]
    };
    let straight = first(STRAIGHT);
    // A truncated cone of half the diameter at its tip has (λL)² = 4.6252 where the prism has 3.5160 (S. Naguleswaran,
    // J. Sound Vib. 172 (1994) 289–304); depth and width of a tapered blade fall like that diameter.
    let ratio = first(Blade { taper: 0.5, ..STRAIGHT }) / straight;
    assert!((ratio * 3.5160 / 4.6252 - 1.0).abs() < 0.01, "{ratio}");
    // A slender beam hardly feels twist in its first mode.
    let ratio = first(Blade { twist: 0.5, ..STRAIGHT }) / straight;
    assert!((0.98..1.05).contains(&ratio), "{ratio}");
}

#[test]
fn a_lumped_ring_has_the_frequencies_of_its_sectors() {
    // Nodal diameter 0: no spring between disks is stretched; three masses in a row remain.
    let generated = lumped::generate(12, 3).unwrap();
    let found = lowest(&generated.structure, 1)[0];
    let sector = |omega: f64| {
        let s = omega * omega;
        let (hub, blade, neck) = (4.0e7, 1.2e5, 6.0e5);
        let tip = neck - neck * neck / (neck - 0.03 * s);
        let middle = blade - blade * blade / (blade + tip - 0.09 * s);
        hub + middle - 0.8 * s
    };
    assert!(sector(TAU * found * 0.999) * sector(TAU * found * 1.001) < 0.0, "{found} Hz");
}

#[test]
fn a_ring_is_the_same_after_a_turn_by_one_sector() {
    let ring = Sectors { ring: true, count: 8, ..SECTORS };
    let mesh = ring.bare_mesh(1300).unwrap();
    let structure = free(&mesh);
    // All diagonal entries come eight times, but for the numbers of the nodes.
    let mut diagonal: Vec<f64> =
        structure.stiffness.entries.iter().filter(|(i, j, _)| i == j).map(|entry| entry.2).collect();
    assert_eq!(diagonal.len() % 8, 0);
    diagonal.sort_by(f64::total_cmp);
    for eight in diagonal.chunks(8) {
        assert!((eight[7] / eight[0] - 1.0).abs() < 1e-9, "{eight:?}");
    }
    let volume = |structure: &Structure| {
        let along: Vec<f64> = (0..structure.dofs()).map(|dof| f64::from(dof % 3 == 0)).collect();
        energy(&along, structure.mass.times(&along))
    };
    let one = volume(&free(&Sectors { ring: false, count: 8, ..SECTORS }.bare_mesh(1300 / 8).unwrap()));
    assert!((volume(&structure) / (8.0 * one) - 1.0).abs() < 1e-12);
}

#[test]
fn shrouds_that_rub_are_at_the_same_place() {
    let ring = Sectors { ring: true, count: 8, ..SECTORS };
    let generated = ring.generate(1300).unwrap();
    let mesh = ring.bare_mesh(1300).unwrap();
    let node = |dof: usize| {
        let name = &generated.structure.names[dof];
        let (node, direction) = name.split_once(':').unwrap();
        (mesh.nodes[node.parse::<usize>().unwrap() - 1], direction.to_owned())
    };
    let Places { first, second, bodies } = &generated.places;
    assert_eq!((first.len() % 8, second.len(), *bodies), (0, first.len(), 8));
    for &(a, b) in first.iter().chain(second) {
        let (a, b) = (node(a), node(b.unwrap()));
        assert_eq!(a.1, b.1);
        let distance: f64 = (0..3).map(|i| (a.0[i] - b.0[i]).powi(2)).sum();
        assert!(distance.sqrt() < 1e-12, "{a:?} {b:?}");
    }
    let angle: f64 = generated.excited[1].phase;
    assert!((angle + 2.0 * PI * 3.0 / 8.0).abs() < 1e-15);
}

#[test]
fn shrouds_touch_in_three_directions_where_they_face_each_other() {
    let place = |mesh: &Mesh, structure: &Structure, dof: usize| {
        let (node, direction) = structure.names[dof].split_once(':').unwrap();
        assert_eq!(direction, "x");
        assert!(structure.names[dof + 1].ends_with(":r") && structure.names[dof + 2].ends_with(":t"));
        mesh.nodes[node.parse::<usize>().unwrap() - 1]
    };
    let ring = Sectors { ring: true, count: 8, ..SECTORS };
    let (generated, mesh) = (ring.generate(1300).unwrap(), ring.bare_mesh(1300).unwrap());
    assert_eq!(generated.sites.len(), generated.places.first.len());
    for site in &generated.sites {
        let a = place(&mesh, &generated.structure, site.first);
        let b = place(&mesh, &generated.structure, site.second.unwrap());
        let distance: f64 = (0..3).map(|i| (a[i] - b[i]).powi(2)).sum();
        assert!(site.normal == 1.0 && distance.sqrt() < 1e-12, "{a:?} {b:?}");
    }
    // The first body of the first site belongs to the first sector, which the second one follows around the axis: a brick of
    // the first body lies at smaller angles.
    let angle = |node: [f64; 3]| node[1].atan2(node[2]);
    let first = place(&mesh, &generated.structure, generated.sites[0].first);
    assert!((angle(first) - PI / 8.0).abs() < 1e-12, "{first:?}");
    // Alone, each side is pressed outwards: at a positive angle the neighbour comes in the direction of t.
    let (generated, mesh) = (SECTORS.generate(600).unwrap(), SECTORS.bare_mesh(600).unwrap());
    for site in &generated.sites {
        let at = angle(place(&mesh, &generated.structure, site.first));
        assert!(site.second.is_none() && (at - site.normal * PI / 24.0).abs() < 1e-12, "{site:?} {at}");
    }
    let chosen = choose_sites(&generated.sites, 4).unwrap();
    assert_eq!(chosen.iter().map(|site| site.normal).collect::<Vec<_>>(), [1.0, 1.0, -1.0, -1.0]);
    assert_eq!(chosen[0].pairs().count(), 3);
    assert!(choose_sites(&generated.sites, generated.sites.len() + 1).is_err());
    assert!(choose_sites(&[], 1).unwrap_err().to_string().contains("--joints"));
}

#[test]
fn contacts_are_spread_and_never_invented() {
    let generated = lumped::generate(10, 1).unwrap();
    let chosen = generated.places.choose(5).unwrap();
    let dofs: Vec<usize> = chosen.iter().map(|pair| pair.0).collect();
    assert_eq!(dofs, [5, 11, 17, 23, 29]);
    assert_eq!(generated.places.choose(20).unwrap().len(), 20);
    assert!(generated.places.choose(21).is_err());
    assert!(generated.places.choose(0).unwrap().is_empty());
}

#[test]
fn presets_have_about_as_many_dofs() {
    for dofs in [300, 1000, 10_000, 50_000] {
        let cells = Cells::of_dofs(dofs);
        let found = 3 * (cells.chord + 1) * (cells.thickness + 1) * cells.span;
        assert!(found.abs_diff(dofs) * 50 <= dofs, "{found} for {dofs}");
    }
}

#[test]
fn a_folded_element_is_refused() {
    // Across the sector's planes.
    let wide = Sectors { blade: Blade { chord: 0.2, twist: 1.5, ..TWISTED }, ..SECTORS };
    let error = wide.generate(1000).err().unwrap();
    assert!(format!("{error:#}").contains("folded"), "{error:#}");
}
