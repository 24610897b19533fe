//! Fig. 1: the grid of particles and its three families of springs, as the model has them.

use muslin::Model;
use muslin::force::{Family, SpringEnds};
use muslin::scene::{Scene, set_value};

use super::drawing::{Dot, Drawing, Label, Stroke};
use super::report::{Cell, Column, Content, Figure, Item, Section, Table};
use super::trial::SCENE;

/// Particles along each side of the drawn grid.
const SIDE: usize = 5;

/// Width of a drawn grid and of the space around it.
const PANEL: f64 = 172.0;
const MARGIN: f64 = 26.0;

/// How far bend springs are drawn beside the structural ones on which they lie.
const BOW: f64 = 10.0;

/// The section with the drawing and the number of springs of the paper's cloth.
pub(crate) fn section() -> Section {
    let paper = Model::new(&scene(10));
    let springs = springs(&paper);
    let grid = paper.cloths()[0].grid;
    let middle = grid.particle(grid.columns / 2, grid.rows / 2);
    let rows = Family::ALL.iter().map(|&family| {
        let of_family = || springs.iter().filter(move |spring| spring.family == family);
        let at_middle = of_family().filter(|spring| spring.particles.contains(&middle)).count();
        let lengths = || of_family().map(|spring| spring.rest_length);
        vec![
            Cell::text(family.name()),
            Cell::text(match family {
                Family::Structural => "the next along columns and rows",
                Family::Shear => "the next along both diagonals",
                Family::Bend => "the next but one along columns and rows",
            }),
            Cell::count(of_family().count() as u64),
            Cell::count(at_middle as u64),
            Cell::rounded(lengths().fold(f64::INFINITY, f64::min)),
            Cell::rounded(lengths().fold(0.0, f64::max)),
        ]
    });
    let table = Table {
        name: "table-1-springs",
        caption: "Springs of the cloth of 10 x 10 particles and 1 m, counted in the model.".to_owned(),
        columns: vec![
            Column::new("family"),
            Column::new("joins a particle to"),
            Column::new("springs"),
            Column::new("at an inner particle"),
            Column::new("shortest [m]"),
            Column::new("longest [m]"),
        ],
        rows: rows.collect(),
    };
    let figure = Figure {
        name: "figure-1-springs",
        caption: format!(
            "Fig. 1: the springs of a grid of {SIDE} x {SIDE} particles, those of its middle particle in bold. Bend springs lie \
             on the structural ones and are drawn beside them."
        ),
        content: Content::Drawing(drawing(&Model::new(&scene(SIDE)))),
    };
    Section {
        name: "springs",
        title: "Fig. 1: particles and springs",
        finding: format!(
            "Three families of springs, as printed: {} springs in the paper's cloth of 10 x 10 particles.",
            springs.len()
        ),
        items: vec![
            Item::text(
                "The paper's cloth is a grid of m x n mass points joined by springs of three families, each with its own \
                 constant. Drawn and counted here are the springs over which a run sums its forces.",
            ),
            Item::Figure(figure),
            Item::Table(table),
        ],
    }
}

fn scene(side: usize) -> Scene {
    let text = [format!("cloth.0.grid.columns={side}"), format!("cloth.0.grid.rows={side}")]
        .iter()
        .try_fold(SCENE.to_owned(), |text, assignment| set_value(&text, assignment));
    // The scene is part of the program.
    text.and_then(|text| Scene::parse(&text)).unwrap_or_else(|error| panic!("{error}"))
}

fn springs(model: &Model) -> Vec<SpringEnds> {
    let mut springs = Vec::new();
    for force in model.forces() {
        force.visit_springs(&mut |spring| springs.push(spring));
    }
    springs
}

/// A panel per family.
fn drawing(model: &Model) -> Drawing {
    let grid = model.cloths()[0].grid;
    let middle = grid.particle(grid.columns / 2, grid.rows / 2);
    let mut drawing = Drawing {
        size: [3.0 * PANEL, PANEL + 16.0],
        strokes: Vec::new(),
        dots: Vec::new(),
        labels: Vec::new(),
    };
    let place = |panel: usize, particle: usize| {
        let (column, row) = grid.cell(particle).unwrap_or((0, 0));
        let spacing = (PANEL - 2.0 * MARGIN) / (SIDE - 1) as f64;
        let x = PANEL * panel as f64 + MARGIN + spacing * column as f64;
        [x, 16.0 + MARGIN + spacing * row as f64]
    };
    let mut springs = springs(model);
    // Bold lines come last, so that none crosses them.
    springs.sort_by_key(|spring| spring.particles.contains(&middle));
    for spring in springs {
        let panel = spring.family as usize;
        drawing.strokes.push(Stroke {
            ends: spring.particles.map(|particle| place(panel, particle)),
            bow: if spring.family == Family::Bend { BOW } else { 0.0 },
            colour: [1, 2, 3][panel],
            is_bold: spring.particles.contains(&middle),
        });
    }
    for (panel, family) in Family::ALL.iter().enumerate() {
        let particles = 0..grid.particle_count();
        drawing.dots.extend(
            particles.map(|particle| Dot { place: place(panel, particle), is_bold: particle == middle }),
        );
        let x = PANEL * (panel as f64 + 0.5);
        drawing.labels.push(Label { place: [x, 18.0], text: family.name().to_owned() });
    }
    drawing
}
