function [colour, light] = style(name)
% A colour that colour-blind readers can distinguish, and its light variant for bands.
  switch name
    case 'inertia'
      colour = [142 90 155] / 255;
    case 'damping'
      colour = [0 158 115] / 255;
    case {'stiffness', 'first'}
      colour = [0 114 178] / 255;
    case 'second'
      colour = [213 94 0] / 255;
    otherwise
      colour = [102 102 102] / 255;
  end
  light = 0.8 + 0.2 * colour;
end
