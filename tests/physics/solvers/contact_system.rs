//! The scaled form of a step's problem: what the gradient methods stand on.

use crate::common::*;

/// A problem of every model, and how many contacts it has at least.
fn scenes() -> Vec<(Scene, usize)> {
    let mut scenes = Vec::new();
    for physics in [SMOOTH, UNTURNING, Physics::FULL] {
        for cone in [FrictionCone::Shifted, FrictionCone::Compressive] {
            let mut scene = pressed_pile(40, 0.1, 3, parameters(10.0, 1e-3, 0.3, 0.4));
            (scene.physics, scene.parameters.cone) = (physics, cone);
            scenes.push((scene, 60));
        }
    }
    let mut line = cradle();
    line.grains[2].position.x = line.grains[0].position.x - 0.999 * line.mean_diameter;
    line.physics = LINE;
    scenes.push((line, 2));
    scenes
}

/// Rows a contact has.
fn entries<M: Model>() -> usize {
    if M::FRICTION { 2 } else { 1 }
}

/// The operator of a system, column by column, from its answers to unit impulses.
fn matrix<M: Model>(system: &mut BodySystem<'_, M>, origin: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let entries = entries::<M>();
    let size = entries * origin.len();
    let mut answer = Vec::new();
    let mut matrix = vec![vec![0.0; size]; size];
    for column in 0..size {
        let mut unit = vec![[0.0; 2]; origin.len()];
        unit[column / entries][column % entries] = 1.0;
        system.write(&unit);
        system.velocities(&mut answer);
        for (row, numbers) in matrix.iter_mut().enumerate() {
            let (contact, entry) = (row / entries, row % entries);
            numbers[column] = answer[contact][entry] - origin[contact][entry];
        }
    }
    matrix
}

/// The largest eigenvalue of a matrix whose rows and columns are scaled, by power iteration.
fn largest_eigenvalue(matrix: &[Vec<f64>], scale: impl Fn(usize) -> f64) -> f64 {
    let size = matrix.len();
    let mut vector: Vec<f64> = (0..size).map(|index| 1.0 + (index % 7) as f64).collect();
    let mut largest = 0.0;
    for _ in 0..300 {
        let next: Vec<f64> = (0..size)
            .map(|row| {
                let sum = |column: usize| matrix[row][column] * scale(column) * vector[column];
                scale(row) * (0..size).map(sum).sum::<f64>()
            })
            .collect();
        largest = next.iter().map(|x| x * x).sum::<f64>().sqrt();
        vector = next.iter().map(|x| x / largest).collect();
    }
    largest
}

struct Check(usize);

impl ProblemVisitor for Check {
    type Output = ();

    fn visit<M: Model>(self, problem: &mut StepProblem<M::Kinematics>, _: &ContactList) {
        let mut root_masses = Vec::new();
        let mut system = BodySystem::<M>::new(problem, &mut root_masses);
        let count = system.len();
        assert!(count >= self.0, "{count} contacts");
        let (mut origin, mut answer, mut weights) = (Vec::new(), Vec::new(), Vec::new());
        let zero = vec![[0.0; 2]; count];
        system.write(&zero);
        system.velocities(&mut origin);
        system.splitting(&mut weights);
        assert_eq!(weights.len(), count);

        let matrix = matrix(&mut system, &origin);
        let entries = entries::<M>();
        let diagonal = |index: usize| match index % entries {
            0 => 1.0,
            _ => system.tangential_diagonal(index / entries),
        };
        for (row, numbers) in matrix.iter().enumerate() {
            assert!((numbers[row] - diagonal(row)).abs() < 1e-11, "{}", numbers[row]);
            for (number, mirrored) in numbers.iter().zip(matrix.iter().map(|other| other[row])) {
                assert!((number - mirrored).abs() < 1e-11, "{number} and {mirrored}");
            }
        }
        // A ⪯ D⁻¹: the largest eigenvalue of D^½ A D^½ is at most 1.
        let scale = |index: usize| (weights[index / entries] / diagonal(index)).sqrt();
        let largest = largest_eigenvalue(&matrix, scale);
        assert!(largest < 1.0 + 1e-9, "{largest}");
        assert!(largest > 0.5, "the bound is not idle: {largest}");

        // A sweep's impulses come back as they were written, and the residual is the natural map's.
        for _ in 0..3 {
            system.sweep();
        }
        let mut impulses = Vec::new();
        system.read(&mut impulses);
        system.velocities(&mut answer);
        let mut error = 0.0;
        for (contact, (&[normal, tangential], [w_n, w_t])) in
            impulses.iter().zip(&answer).enumerate()
        {
            let root = system.root_mass(contact);
            let bound = system.friction_bound(contact, normal);
            let e_n = normal - (normal - w_n).max(0.0);
            let moved = tangential - w_t / system.tangential_diagonal(contact);
            let e_t = if M::FRICTION { tangential - moved.clamp(-bound, bound) } else { 0.0 };
            error += root * root * (e_n * e_n + e_t * e_t);
        }
        let before = system.residual();
        system.write(&impulses);
        assert!((system.residual() - before).abs() < 1e-9 * before);
        let scale = scale_of_residual::<M>(problem);
        let found = residual::<M>(problem);
        assert!(found > 0.0 && (error.sqrt() / scale - found).abs() < 1e-9 * found);
    }
}

/// ‖(m_n v_n^free, m_t v_t^free)‖, N·s.
fn scale_of_residual<M: Model>(problem: &StepProblem<M::Kinematics>) -> f64 {
    let rows = problem.rows.fixed.iter().map(|row| (&row.row, true));
    let rows = rows.chain(problem.rows.pairs.iter().map(|row| (&row.row, false)));
    let mut sum = 0.0;
    for (row, fixed) in rows {
        let i = &problem.bodies.free[row.i as usize];
        let [normal, tangential] = if fixed {
            M::Kinematics::velocity(row.normal, i)
        } else {
            M::Kinematics::relative_velocity(row.normal, i, &problem.bodies.free[row.j as usize])
        };
        let normal = normal + row.restitution_velocity;
        let tangential =
            if M::FRICTION { tangential / M::Kinematics::TANGENTIAL_COMPLIANCE } else { 0.0 };
        sum += row.effective_mass.powi(2) * (normal * normal + tangential * tangential);
    }
    sum.sqrt()
}

#[test]
fn scaled_variables_have_a_symmetric_operator_with_a_known_diagonal() {
    for (scene, contacts) in scenes() {
        start(&scene).next_problem(Check(contacts));
    }
}
