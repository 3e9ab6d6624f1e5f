function label(across, up)
% Labels the current axes, with a space for the dot between factors, which some fonts lack.
  xlabel(plain(across));
  ylabel(plain(up));
  set(gca, 'FontSize', 9);
end

function text = plain(text)
  text = strrep(text, char([194 183]), ' ');
  text = strrep(text, char(183), ' ');
end
