//! A hierarchy of four children a node, as the shader reads it: obvhs builds a binary one, whose nodes are merged here.

use std::time::Duration;

use obvhs::{
    BvhBuildParams,
    bvh2::{Bvh2, builder::build_bvh2_from_tris},
};
use umbra4::model::Model;
use umbra4_core::glam::Vec3;

use crate::primary::rival_triangles;

/// Children of a node.
pub const WIDTH: usize = 4;
/// Set in a child that is a leaf: the number of its triangles and the first of them follow.
const LEAF: u32 = 1 << 31;
/// Bits below the number of triangles of a leaf: the first of them.
const FIRST_BITS: u32 = 27;
/// Most triangles of a leaf.
const LEAF_MOST: u32 = 15;
/// Most triangles, those that are cut counted more than once; there are fewer nodes, whose indices have 28 bits.
pub const TRIANGLES_MOST: usize = 1 << FIRST_BITS;

/// obvhs' slow build, with all nodes considered for a better place: the build is not part of the rival's time.
const BUILD: BvhBuildParams = BvhBuildParams { reinsertion_batch_ratio: 1.0, ..BvhBuildParams::slow_build() };

/// The hierarchy.
#[derive(Clone, Debug)]
pub struct Bvh4 {
    /// Lower and upper x, y and z of the four children of every node.
    pub boxes: Vec<[[f32; WIDTH]; 6]>,
    /// The children of every node, the one with the largest box first: nodes, or leaves.
    pub children: Vec<[u32; WIDTH]>,
    /// A corner and the two edges from it, in the order of the leaves; the fourth number pads.
    pub triangles: Vec<[[f32; 4]; 3]>,
    /// Nodes on the longest path from the root.
    pub depth: u32,
}

impl Bvh4 {
    /// Builds the hierarchy of all triangles of a model.
    pub fn new(model: &Model) -> Self {
        let corners = rival_triangles(model);
        let binary = match corners.len() {
            0 => Bvh2::default(),
            _ => build_bvh2_from_tris(&corners, BUILD, &mut Duration::default()),
        };
        let triangles = binary.primitive_indices.iter().map(|&index| {
            let triangle = &corners[index as usize];
            let [a, b, c] = [triangle.v0, triangle.v1, triangle.v2].map(Vec3::from);
            [a, b - a, c - a].map(|v| v.extend(0.0).to_array())
        });
        let mut wide = Self { boxes: Vec::new(), children: Vec::new(), triangles: triangles.collect(), depth: 1 };
        wide.merge(&binary);
        wide
    }

    /// Merges binary nodes, breadth first: what all rays visit lies together.
    fn merge(&mut self, binary: &Bvh2) {
        // Binary nodes that become wide ones, in their order, and how deep these lie.
        let mut queue = vec![(0, 1)];
        while let Some(&(root, depth)) = queue.get(self.children.len()) {
            self.depth = self.depth.max(depth);
            // Empty leaves in boxes that are inside out, so that few rays or none enter them.
            let mut boxes = inside_out(binary, root);
            let mut children = [LEAF; WIDTH];
            for (slot, index) in opened(binary, root).into_iter().enumerate() {
                let node = &binary.nodes[index];
                for axis in 0..3 {
                    boxes[2 * axis][slot] = node.aabb().min[axis];
                    boxes[2 * axis + 1][slot] = node.aabb().max[axis];
                }
                children[slot] = if node.is_leaf() {
                    debug_assert!(node.prim_count <= LEAF_MOST, "a leaf of {} triangles", node.prim_count);
                    LEAF | node.prim_count << FIRST_BITS | node.first_index
                } else {
                    queue.push((index, depth + 1));
                    queue.len() as u32 - 1
                };
            }
            self.boxes.push(boxes);
            self.children.push(children);
        }
    }
}

/// Four times the box of a node, its upper coordinates as the lower ones.
fn inside_out(binary: &Bvh2, node: usize) -> [[f32; WIDTH]; 6] {
    let mut boxes = [[0.0; WIDTH]; 6];
    if let Some(node) = binary.nodes.get(node) {
        for axis in 0..3 {
            boxes[2 * axis] = [node.aabb().max[axis]; WIDTH];
            boxes[2 * axis + 1] = [node.aabb().min[axis]; WIDTH];
        }
    }
    boxes
}

/// The binary nodes that become the children of the wide node made from `root`: the largest is opened while there is
/// room. The one with the largest box comes first, as the likeliest to stop a ray.
fn opened(binary: &Bvh2, root: usize) -> Vec<usize> {
    let children = |index: usize| {
        let first = binary.nodes[index].first_index as usize;
        [first, first + 1]
    };
    let area = |index: usize| binary.nodes[index].aabb().half_area();
    let mut opened = match binary.nodes.get(root) {
        None => return Vec::new(),
        Some(node) if node.is_leaf() => return vec![root],
        Some(_) => children(root).to_vec(),
    };
    while opened.len() < WIDTH {
        let inner = (0..opened.len()).filter(|&slot| !binary.nodes[opened[slot]].is_leaf());
        let Some(largest) = inner.max_by(|&a, &b| f32::total_cmp(&area(opened[a]), &area(opened[b]))) else { break };
        let node = opened.swap_remove(largest);
        opened.extend(children(node));
    }
    opened.sort_by(|&a, &b| f32::total_cmp(&area(b), &area(a)));
    opened
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tiny;

    #[test]
    fn every_triangle_lies_in_one_box_at_least() {
        let model = tiny(8).model;
        let wide = Bvh4::new(&model);
        let mut found = vec![0; wide.triangles.len()];
        let leaves = wide.children.iter().flatten().filter(|&child| child & LEAF != 0);
        for leaf in leaves {
            let first = (leaf & (TRIANGLES_MOST as u32 - 1)) as usize;
            let count = ((leaf & !LEAF) >> FIRST_BITS) as usize;
            found[first..first + count].iter_mut().for_each(|times| *times += 1);
        }
        assert!(found.len() >= model.triangles.len() && found.iter().all(|&times| times == 1), "{found:?}");
        let nodes = wide.children.iter().flatten().filter(|&child| child & LEAF == 0);
        assert_eq!(nodes.count() + 1, wide.children.len());
    }

    #[test]
    fn a_model_may_be_empty_or_a_single_triangle() {
        let mut model = Model::default();
        assert_eq!(Bvh4::new(&model).children, [[LEAF; WIDTH]]);
        model.vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        model.triangles = vec![[0, 1, 2]];
        let wide = Bvh4::new(&model);
        assert_eq!((wide.children.len(), wide.depth), (1, 1));
        assert_eq!(wide.triangles.len(), ((wide.children[0][0] & !LEAF) >> FIRST_BITS) as usize);
    }
}
