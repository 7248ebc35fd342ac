use super::*;

#[test]
fn counts_are_the_nearest_at_or_above_the_asked() {
    for model in [Model::Sphere, Model::Terrain, Model::Knot] {
        let (most, (per_step, _)) = (model.most_triangles(), model.grid());
        for asked in [model.fewest_triangles(), 9999, 1_000_000, 20_000_000, most - 1, most] {
            let recipe = Recipe::new(model, asked);
            let triangles = recipe.grid_triangles();
            assert!(triangles >= asked && triangles <= most);
            let coarser = per_step * ((triangles / per_step).isqrt() - 1).pow(2);
            assert!(coarser < asked, "{model}: {coarser} would do for {asked}");
            assert!(recipe.surface().unwrap().vertices() < 1 << 31);
        }
    }
}
